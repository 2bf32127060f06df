"""This project: `python with_ours.py PLANT SAFETY`; one run as `simulate` makes it, many as a sweep makes rows."""

import sys
from importlib.metadata import version

from work import told

from scenarios.definition.experiment import open_experiment
from scenarios.simulation.loop import simulate
from scenarios.studies.sweep.row import run_batch
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import open_study

PLANT, SAFETY = sys.argv[1:]
CHANGES = (f"plant.name='{PLANT}'", f"safety.filter='{SAFETY}'")
PERIODS = 1818
ONE = open_experiment("shape", CHANGES)


def work(runs: int, steps: int) -> None:
    if runs == 1:
        simulate(ONE, 0)
        return
    for batch in open_study("shape", CHANGES, (), parse_seeds(f"0:{runs}")).batches():
        run_batch(batch)


many = [(1000, PERIODS)] if PLANT == "saturated" else []
told("angle-formation", version("angle-formation"), work, (1, PERIODS), *many)
