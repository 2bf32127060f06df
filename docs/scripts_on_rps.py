"""Run scripts for the Robotarium on the public simulator and here, and put where they end beside each other.

    .venv/bin/python docs/scripts_on_rps.py RPS/rps/examples --original RPS --python PYTHON --keep FOLDER

RPS is the public simulator's source, of either generation, PYTHON an interpreter that has what it needs
(numpy, matplotlib, scipy, cvxopt, quadprog). Nothing is fetched. Both sides begin at the initial conditions, with one
seed. The public simulator runs twice: as it is, and with its solver run on to 1e-9 and robots moved on arcs, which
tells what its numerics do. With --nudge 1e-9 it runs once more in that way, its first robot a billionth of a metre
aside, which tells how far apart its own runs end. What has run is kept in FOLDER and not run again.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PEER = ROOT / "docs" / "peer.py"
PERIOD = 0.033
PLANTS = ("saturated", "pymunk")


@dataclass(frozen=True)
class End:
    """How a script ended on one side: outcome, steps, last poses (3, N), verdict, whether there is a figure of its."""

    outcome: str
    steps: int
    poses: np.ndarray
    accepted: bool
    figure: bool = False

    def text(self) -> str:
        """Outcome and steps."""
        return f"{self.outcome}, {self.steps}"


def scripts(folder: Path) -> list[Path]:
    """All scripts below a folder that make robots."""
    return [
        path
        for path in sorted(folder.rglob("*.py"))
        if "rps.robotarium" in path.read_text(encoding="utf-8", errors="replace") and "__init__" not in path.name
    ]


def on_rps(script: Path, out: Path, given: argparse.Namespace, exact: bool, nudge: float = 0.0) -> End | None:
    """The end on the public simulator."""
    if not out.exists():
        environment = os.environ | {"PYTHONPATH": str(given.original), "RPS_EXACT": "1" if exact else "0"}
        environment["RPS_NUDGE"] = str(nudge)
        command = [given.python, str(PEER), str(script), str(out), str(given.seed), str(given.limit), "exact"]
        _run(command, script, environment, out.with_suffix(".log"))
    if not out.exists():
        return None
    told = json.loads(out.read_text())
    runs = told["runs"]
    if not runs:
        return End(told["outcome"], 0, np.empty((3, 0)), False)
    longest = max(reversed(runs), key=lambda run: run["steps"])
    return End(told["outcome"], longest["steps"], np.array(longest["end"]), longest["accepted"])


def nudged(script: Path, keep: Path, given: argparse.Namespace) -> End | None:
    """The end on the public simulator without its numerics, from a start that is so little another one."""
    return on_rps(script, keep / f"rps-exact-{given.nudge:g}.json", given, exact=True, nudge=given.nudge)


def here(script: Path, out: Path, given: argparse.Namespace, plant: str) -> End | None:
    """The end on one of our plants."""
    if not (out / "result.json").exists():
        command = [sys.executable, "-m", "scenarios", "script", str(script), "--plant", plant, "--no-recording"]
        command += ["--seed", str(given.seed), "--duration", str(given.limit * PERIOD), "--out", str(out)]
        _run(command, script, os.environ | {"PYTHONPATH": str(ROOT)}, out.with_suffix(".log"))
    if not (out / "result.json").exists():
        return None
    result = json.loads((out / "result.json").read_text())
    with np.load(out / "trajectory.npz") as states:
        poses = states["poses"][-1].T
    figure = (out / "figure.png").exists()
    return End(result["outcome"], result["steps"], poses, result["testbed"]["accepted"], figure)


def apart(a: End | None, b: End | None) -> str:
    """How far the axles are from each other at the end, millimetres."""
    if a is None or b is None or a.poses.shape != b.poses.shape or not a.poses.size:
        return "-"
    return f"{1e3 * np.hypot(*(a.poses - b.poses)[:2]).max():.2g}"


def verdict(end: End | None) -> str:
    """In a word."""
    return "-" if end is None else "accepted" if end.accepted else "rejected"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--original", type=Path, required=True)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--keep", type=Path, default=Path("runs/scripts-on-rps"))
    parser.add_argument("--limit", type=int, default=12_000, help="steps, after which a script is stopped")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--nudge", type=float, default=0.0, help="metres")
    parser.add_argument("--only", nargs="*", default=(), help="names of scripts")
    parser.add_argument("--markdown", type=Path)
    given = parser.parse_args()
    given.folder, given.original, given.keep = (p.resolve() for p in (given.folder, given.original, given.keep))
    given.python = os.path.abspath(given.python)
    head = (
        "script",
        "rps",
        "as it is (mm)",
        "exact (mm)",
        *(["exact, nudged (mm)"] if given.nudge else []),
        "saturated",
        "pymunk",
        "rps",
        "saturated",
        "pymunk",
        "figure",
    )
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    print(lines[0], lines[1], sep="\n", flush=True)
    for script in scripts(given.folder):
        if given.only and script.stem not in given.only:
            continue
        keep = given.keep / script.relative_to(given.folder).with_suffix("")
        keep.mkdir(parents=True, exist_ok=True)
        as_it_is = on_rps(script, keep / "rps.json", given, exact=False)
        exact = on_rps(script, keep / "rps-exact.json", given, exact=True)
        ours: list[Any] = [here(script, keep / plant, given, plant) for plant in PLANTS]
        row = (
            f"`{script.relative_to(given.folder).with_suffix('')}`",
            "-" if as_it_is is None else as_it_is.text(),
            apart(as_it_is, ours[0]),
            apart(exact, ours[0]),
            *([apart(exact, nudged(script, keep, given))] if given.nudge else []),
            *("-" if end is None else end.text() for end in ours),
            *(verdict(end) for end in (as_it_is, *ours)),
            "yes" if any(end is not None and end.figure for end in ours) else "",
        )
        lines.append(f"| {' | '.join(row)} |")
        print(lines[-1], flush=True)
    if given.markdown is not None:
        given.markdown.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _run(command: list[str], script: Path, environment: dict[str, str], log: Path) -> None:
    """Run a command where it finds the pictures beside the script and may write."""
    log.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch, log.open("w") as output:
        for picture in (*script.parent.glob("*.png"), *script.parent.glob("*.mat"), *script.parent.glob("*.npy")):
            (Path(scratch) / picture.name).symlink_to(picture)
        subprocess.run(command, cwd=scratch, env=environment, stdout=output, stderr=subprocess.STDOUT, check=False)


if __name__ == "__main__":
    main()
