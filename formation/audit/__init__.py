"""What can be found out about a law by asking it: is it local, free of frames, at rest at its target, and stable there?

A law is a black box here, and only what the runner takes for granted is demanded of it. Everything is measured on
single integrators, at random places of about the target's size and at the target itself.
No law is named here.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formation.audit.disturbed import bias, delay, growth, noise
from formation.audit.measurements import (
    batches,
    compass,
    frames,
    graph_kind,
    locality,
    measurements,
    mirrored_frames,
    output,
    repeats,
)
from formation.audit.subject import Finding as Finding
from formation.audit.subject import Subject as Subject
from formation.audit.target import derivative, fixes, mirror_image, rest, sampling, stability, zero_modes

__all__ = ["Finding", "Subject", "audit"]


def audit(subject: Subject, control_period: float, seed: int = 0) -> list[Finding]:
    """All findings about a law; only the first one where its output cannot be used.

    Args:
        subject: the law with its target.
        control_period: seconds over which a command is held.
        seed: of the random configurations and frames.
    """
    checks: dict[str, Callable[[Subject, np.random.Generator], Finding]] = {
        "same answer again": repeats,
        "batches": batches,
        "locality": locality,
        "graph": graph_kind,
        "measurements": measurements,
        "compass": compass,
        "local frames": frames,
        "mirrored frames": mirrored_frames,
        "rest at the target": rest,
        "what it fixes": fixes,
        "mirror image": mirror_image,
        "derivative": derivative,
        "zero modes": zero_modes,
        "local stability": stability,
        "control period": lambda subject, _: sampling(subject, control_period),
        "delay": lambda subject, _: delay(subject, control_period),
        "growth of errors": lambda subject, _: growth(subject),
        "bias": lambda subject, _: bias(subject),
        "noise": lambda subject, _: noise(subject, control_period),
    }
    findings = [_attempt("output", output, subject, seed)]
    if findings[0].holds:
        findings += [_attempt(name, check, subject, seed) for name, check in checks.items()]
    return findings


@np.errstate(all="ignore")  # NaN is what some checks feed, and a number that others report
def _attempt(
    name: str, check: Callable[[Subject, np.random.Generator], Finding], subject: Subject, seed: int
) -> Finding:
    try:
        return check(subject, np.random.default_rng(seed))
    except Exception as error:  # whatever a law raises, it does not do what is asked
        return Finding(name, False, remark=f"raised {type(error).__name__}: {error}")
