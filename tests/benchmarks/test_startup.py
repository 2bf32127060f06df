"""What a person waits for: processor time of whole commands, interpreter start included."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize(("command", "at_most"), [(("list",), 0.4), (("run", "shape"), 3.0)], ids=["list", "run"])
def test_command(
    benchmark: BenchmarkFixture,
    target: Callable[[str, float, float, str], None],
    tmp_path: Path,
    command: tuple[str, ...],
    at_most: float,
) -> None:
    """The least of a few starts: the first one reads the packages from the disk."""
    spent = []

    def start() -> None:
        before = os.times()
        subprocess.run(
            [sys.executable, "-m", "scenarios", *command], cwd=tmp_path, check=True, stdout=subprocess.DEVNULL
        )
        after = os.times()
        spent.append(after.children_user - before.children_user + after.children_system - before.children_system)

    benchmark.pedantic(start, rounds=5, warmup_rounds=1)
    target(f"formation {' '.join(command)}, processor time", min(spent), at_most, "s")
