"""What a person waits for: whole commands, interpreter start included."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from pytest_benchmark.fixture import BenchmarkFixture

Target = Callable[[str, float, float, str], None]


def least(benchmark: BenchmarkFixture, folder: Path, *command: str) -> tuple[float, float]:
    """Seconds of processor time, of all processes, and of waiting: each the least of a few starts.

    The first start reads the packages from the disk, and compiles the filter where that has not been done.
    """
    processor, wall = [], []

    def start() -> None:
        before, begin = os.times(), perf_counter()
        subprocess.run([sys.executable, "-m", "scenarios", *command], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        after, end = os.times(), perf_counter()
        processor.append(after.children_user - before.children_user + after.children_system - before.children_system)
        wall.append(end - begin)

    benchmark.pedantic(start, rounds=5, warmup_rounds=1)
    return min(processor), min(wall)


def test_list(benchmark: BenchmarkFixture, target: Target, tmp_path: Path) -> None:
    processor, _ = least(benchmark, tmp_path, "list")
    target("formation list, processor time", processor, 0.4, "s")


def test_run(benchmark: BenchmarkFixture, target: Target, tmp_path: Path) -> None:
    processor, wall = least(benchmark, tmp_path, "run", "shape")
    target(f"formation run shape, wall time ({processor:.2f} s of processors)", wall, 3.0, "s")
