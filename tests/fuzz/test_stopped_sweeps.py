"""Sweeps that are stopped at random moments and continued, again and again, until they are done: are the rows the same?

    python tests/fuzz/test_stopped_sweeps.py [--sweeps 20] [--seed 1]

Each sweep is the command, with processes of its own, stopped by SIGKILL, SIGTERM or SIGINT. What it ends with is
compared, byte for byte, with a sweep that nothing stopped. Exit code 1 where a file differs.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)

LONGEST_HEADER = 400
"""Bytes above the first row, at most."""

FILES = ("rows.csv", "summary.json", "study.json")

STUDIES = (
    ("--plant", "saturated", "--set", "duration_s=60", "--seeds", "0:40000,50000", "--workers", "2"),
    ("--set", "duration_s=3", "--seeds", "0:1200", "--vary", "safety.filter=none,decentralised", "--workers", "2"),
    ("--set", "duration_s=3", "--seeds", "0:1200", "--workers", "1"),
)
"""Batches and single runs, varied and not, in this process and in others; some seconds each, to be stopped in."""

PATIENCE = 20
"""Times that one sweep is stopped, at most, before it is left alone to end."""

UNSEEN = 0.2
"""Share of the stops that do not wait for a new row, but strike while the packages load or the workers begin."""


def command(study: tuple[str, ...], out: Path) -> list[str]:
    return [sys.executable, "-m", "scenarios", "sweep", "shape", *study, "--out", str(out)]


def stopped(study: tuple[str, ...], out: Path, seen: bool, after: float, by: signal.Signals) -> bool:
    """Start the sweep and stop it some seconds later, or after its first new row; whether it was stopped."""
    before = size(out)
    process = subprocess.Popen(command(study, out), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while seen and process.poll() is None and size(out) <= before + LONGEST_HEADER:
        time.sleep(0.01)
    try:
        _, said = process.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        process.send_signal(by)
        _, said = process.communicate()
        if process.returncode != 0:
            return True
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command(study, out))}: exit code {process.returncode}: {said}")
    return False


def size(out: Path) -> int:
    """Bytes of the rows."""
    return sum(len(path.read_bytes()) for path in (out / "rows.partial.csv", out / "rows.csv") if path.exists())


def differing(out: Path, whole: Path) -> list[str]:
    """Files that are not those of a sweep that nothing stopped, or should not be there."""
    left = [path.name for path in out.iterdir() if path.name not in FILES]
    return left + [name for name in FILES if (out / name).read_bytes() != (whole / name).read_bytes()]


def test_a_killed_sweep_leaves_no_lock_and_ends_with_the_rows_of_an_uninterrupted_one(tmp_path: Path) -> None:
    study = ("--set", "duration_s=0.1", "--seeds", "0:60", "--workers", "1")
    assert stopped(study, tmp_path / "stopped", True, 0.0, signal.SIGKILL)
    rows = (tmp_path / "stopped" / "rows.partial.csv").read_bytes()
    for folder in ("stopped", "whole"):
        subprocess.run(command(study, tmp_path / folder), stdout=subprocess.DEVNULL, check=True)
    assert differing(tmp_path / "stopped", tmp_path / "whole") == []
    assert (tmp_path / "whole" / "rows.csv").read_bytes().startswith(rows[: rows.rindex(b"\n") + 1])


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--sweeps", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    rng = random.Random(given.seed)
    os.environ["OMP_NUM_THREADS"] = "1"
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job passes on that it ignores it
    different = untouched = 0
    with tempfile.TemporaryDirectory() as scratch:
        whole = [Path(scratch) / f"whole-{number}" for number in range(len(STUDIES))]
        for study, out in zip(STUDIES, whole, strict=True):
            subprocess.run(command(study, out), stdout=subprocess.DEVNULL, check=True)
        for number in range(given.sweeps):
            which = number % len(STUDIES)
            out, stops = Path(scratch) / f"stopped-{number}", []
            while len(stops) < PATIENCE:
                by = rng.choice(SIGNALS)
                if not stopped(STUDIES[which], out, rng.random() > UNSEEN, rng.uniform(0.0, 1.5), by):
                    break
                stops.append(f"{by.name} at {size(out)} bytes")
            else:
                subprocess.run(command(STUDIES[which], out), stdout=subprocess.DEVNULL, check=True)
            wrong = differing(out, whole[which])
            different, untouched = different + bool(wrong), untouched + (not stops)
            verdict = f"DIFFERENT: {', '.join(wrong)}" if wrong else "the same files"
            print(f"sweep {number + 1}: {verdict}; stopped {len(stops)} times: {', '.join(stops)}", flush=True)
    print(f"{given.sweeps} sweeps, {different} different, {untouched} never stopped")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
