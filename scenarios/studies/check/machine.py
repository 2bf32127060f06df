"""The machine, as far as the last digits of a run depend on it."""

from __future__ import annotations

import platform
from pathlib import Path

import numpy as np

from scenarios.measures.result import versions

PROJECT = "angle-formation"


def fingerprint() -> dict[str, str]:
    """What has to be equal for two runs to be bit-identical: versions, system, C library, processor and its kernels.

    numpy and the C library choose their kernels for sin, cos, exp and complex products by what the processor can do.
    """
    simd = np.show_config(mode="dicts")["SIMD Extensions"]
    libc = " ".join(platform.libc_ver()).strip() or platform.release()
    return {
        **versions(),
        "system": f"{platform.system()} {platform.machine()}",
        "c library": libc,
        "processor": _processor(),
        "numpy kernels": " ".join([*simd["baseline"], *simd.get("found", [])]),
    }


def same_bits(a: dict[str, str], b: dict[str, str]) -> bool:
    """Whether machines with these fingerprints give the same bits; a release of this project changes none."""
    return {**a, PROJECT: ""} == {**b, PROJECT: ""}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
