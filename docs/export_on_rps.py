"""What ``formation export --check`` says on ``saturated`` beside what the public simulator does, run by run.

    .venv/bin/python docs/export_on_rps.py --original RPS --python PYTHON --seeds 10 [SCENARIO ...]

RPS is the source of ``rps`` 2.1, PYTHON an interpreter that has what it needs. Both begin at the chargers, with one
seed of the generators on both sides. Verdicts are compared where robots come to their start on both.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.errors import InputError
from scenarios.export.script import script
from scenarios.studies.exported import arrival

PEER = Path(__file__).resolve().with_name("peer.py")
LIMIT = 22_000
"""Steps, its drive to the start included."""


def exportable() -> list[str]:
    """The scenarios of the library that a script can carry."""
    names = []
    for file in sorted(LIBRARY.glob("*.toml")):
        with suppress(InputError):
            script(open_experiment(file.stem))
            names.append(file.stem)
    return names


def peers(experiment: Experiment, path: Path, seed: int, given: argparse.Namespace) -> tuple[bool, bool, bool, float]:
    """Whether the public simulator brings robots to their start, reaches the goal, accepts; the sum of angle errors."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "end.json"
        command = [given.python, str(PEER), str(path), str(out), str(seed), str(LIMIT), "driven"]
        environment = os.environ | {"PYTHONPATH": given.original}
        subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)
        told = json.loads(out.read_text())
    run = told["runs"][-1]
    if run["initialising"]:
        return False, False, False, np.inf
    points = experiment.nid.project(np.array(run["end"]).T)
    error = float(np.abs(experiment.angles.errors(points, experiment.of_phase(-1).target_angles)).sum())
    return True, error < experiment.goal, run["accepted"], error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenarios", nargs="*", help="all that can be exported where none is named")
    parser.add_argument("--original", type=os.path.abspath, required=True)
    parser.add_argument("--python", type=os.path.abspath, default=sys.executable)
    parser.add_argument("--seeds", type=int, default=10)
    given = parser.parse_args()
    total = np.zeros(4, dtype=int)
    print("| scenario | arrive on `rps` | arrive here | alike | verdicts alike | angle errors, median: `rps`, here |")
    print("|---|---|---|---|---|---|")
    for name in given.scenarios or exportable():
        experiment = open_experiment(name)
        arrive, errors, alike, judged, verdicts = np.zeros(2, dtype=int), [], 0, 0, 0
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "exported.py"
            text = script(experiment, 0).replace("SHOW_FIGURE = True", "SHOW_FIGURE = False")
            path.write_text(text, encoding="utf-8")
            for seed in range(given.seeds):
                started, reached, accepted, error = peers(experiment, path, seed, given)
                ours = arrival(experiment, path, "saturated", seed)
                there, here = started and reached and accepted, ours.started and ours.reached and ours.accepted
                arrive += there, here
                alike += there == here
                both = started and ours.started
                judged += both
                verdicts += both and accepted == ours.accepted
                errors.append((error, ours.error_sum))
                if there != here or started != ours.started or accepted != ours.accepted:
                    told = f"rps {there} {accepted} {error:.1e}, here {here} {ours.accepted} {ours.error_sum:.1e}"
                    print(f"{name}, seed {seed}, arrives, accepted, error: {told}", file=sys.stderr)
        total += given.seeds, alike, judged, verdicts
        medians = ", ".join(f"{median:.1e}" for median in np.median(errors, axis=0))
        counts = [f"{count} of {given.seeds}" for count in (*arrive, alike)]
        row = (name, *counts, f"{verdicts} of {judged}", medians)
        print(f"| `{row[0]}` | {' | '.join(row[1:])} |", flush=True)
    runs, alike, judged, verdicts = total
    print(f"\n{alike} of {runs} alike on whether they arrive, {verdicts} of {judged} on the verdict")


if __name__ == "__main__":
    main()
