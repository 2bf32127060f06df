"""Why runs missed their goals."""

from functools import partial
from pathlib import Path

import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.simulation.loop import simulate
from scenarios.studies.sweep import folder as place
from scenarios.studies.sweep.cause import MEANINGS, Ends, cause_of
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import open_study
from scenarios.studies.sweep.sweep import sweep
from scenarios.work.processes import run_all

LEGAL = ("plant.name=saturated", "random_start={x_m=[-1.5, 1.5], y_m=[-0.9, 0.9], min_separation_m=0.135}")


@pytest.mark.parametrize(
    ("seeds", "changes", "cause"),
    [
        ("56", LEGAL, "tight_end"),  # agents 1 and 2 start 0.185 m apart, 2 and 5 should end 0.131 m apart
        ("1347", LEGAL, "stuck"),  # goes on for half a minute
        ("0", ("plant.name=saturated", "duration_s=4"), "moving"),
        ("1", ("plant.name=saturated", "safety.filter=none", "goal.accepted=true"), "collision"),
    ],
)
def test_watched_runs_and_runs_by_themselves_tell_one_cause(
    seeds: str, changes: tuple[str, ...], cause: str, tmp_path: Path
) -> None:
    swept = sweep(open_study("shape", changes, (), parse_seeds(seeds)), tmp_path, partial(run_all, workers=1), _quiet)
    [row] = place.read_rows(tmp_path)
    [misses] = swept.summaries[0].causes
    assert (row.cause, misses.cause, misses.count) == (cause, cause, 1)
    experiment = open_experiment("shape", changes)
    alone = Ends.of(simulate(experiment, int(seeds)))
    assert cause_of(experiment, row.outcome, row.violations.split(), alone) == cause
    assert cause in MEANINGS


def test_robots_that_stand_where_they_should_not_are_told_from_those_that_move() -> None:
    experiment = open_experiment("shape", ("plant.name=saturated",))
    ends = Ends.of(simulate(experiment, 0))
    assert cause_of(experiment, "not_converged", (), ends) == "resting"
    assert cause_of(experiment, "converged", (), ends) == ""


def _quiet(done: int, total: int) -> None:
    """No progress."""
