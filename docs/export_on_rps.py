"""What ``formation export --check`` says on ``saturated`` beside what the public simulator does, run by run.

    .venv/bin/python docs/export_on_rps.py --original RPS --python PYTHON --seeds 10 [SCENARIO ...]

RPS is the source of ``rps`` 2.1, PYTHON an interpreter that has what it needs. Both begin at the chargers, with one
seed of the generators on both sides.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.export.script import script
from scenarios.studies.exported import arrival

PEER = Path(__file__).resolve().with_name("peer.py")
SCENARIOS = ("shape", "maneuver", "maneuver-caption", "maneuver-testbed", "scale-only", "orientation-only", "fastest")
LIMIT = 22_000
"""Steps, its drive to the start included."""


def peers(experiment: Experiment, path: Path, seed: int, given: argparse.Namespace) -> tuple[bool, bool, bool, float]:
    """Whether the public simulator brings robots to their start, reaches the goal, accepts; the sum of angle errors."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "end.json"
        command = [given.python, str(PEER), str(path), str(out), str(seed), str(LIMIT), "driven"]
        environment = os.environ | {"PYTHONPATH": str(given.original)}
        subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)
        told = json.loads(out.read_text())
    run = told["runs"][-1]
    if run["initialising"]:
        return False, False, False, np.inf
    points = experiment.nid.project(np.array(run["end"]).T)
    error = float(np.abs(experiment.angles.errors(points, experiment.target_angles)).sum())
    return True, error < experiment.goal, run["accepted"], error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenarios", nargs="*", default=SCENARIOS)
    parser.add_argument("--original", type=Path, required=True)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--seeds", type=int, default=10)
    given = parser.parse_args()
    alike, verdicts, runs = 0, 0, 0
    for name in given.scenarios:
        experiment = open_experiment(name)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "exported.py"
            text = script(experiment, 0).replace("SHOW_FIGURE = True", "SHOW_FIGURE = False")
            path.write_text(text, encoding="utf-8")
            for seed in range(given.seeds):
                started, reached, accepted, error = peers(experiment, path, seed, given)
                ours = arrival(experiment, path, "saturated", seed)
                arrives = started and reached and accepted
                runs += 1
                alike += arrives == ours.arrives
                verdicts += accepted == ours.accepted
                print(
                    f"{name}, seed {seed}: rps {'arrives' if arrives else 'misses'} ({error:.1e} rad), here "
                    f"{'arrives' if ours.arrives else 'misses'} ({ours.error_sum:.1e} rad); verdicts "
                    f"{'alike' if accepted == ours.accepted else 'differ'}",
                    flush=True,
                )
    print(f"{alike} of {runs} alike on whether they arrive, {verdicts} of {runs} on the verdict")


if __name__ == "__main__":
    main()
