"""How often a scenario's law reaches its goal from random starts, as ideal single integrators."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scenarios.definition.bounds import MOST_STARTS
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import judged_end
from scenarios.simulation.loop import simulate
from scenarios.simulation.schedule import count_periods

Progress = Callable[[int, int], None]
"""Called with the number of control periods done and of all."""

DURATION = 120.0
"""Seconds; long enough for the slowest law, so that a miss is a wrong equilibrium."""

BATCH_STATES = 5_000_000
"""Robots times control periods that advance as one array: half a GB of states, however many starts there are."""

COMPASS_BIAS_DEG = 5.0
"""Standard deviation of the compass errors in the second column of shares."""

RANDOM_START = ("random_start.x_m=[-1.4, 1.4]", "random_start.y_m=[-0.8, 0.8]")
"""Where all laws start, as changes of a scenario."""


def part_of(on_progress: Progress, done: int, parts: int) -> Progress:
    """The progress of one of equal ``parts``, after ``done`` of them, told as progress of the whole."""
    return lambda period, periods: on_progress(done * periods + period, parts * periods)


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def share_reaching(experiment: Experiment, starts: int, on_period: Progress) -> float:
    """The share of the runs with seeds from 0 that end below the goal, on a plant without contact.

    Args:
        experiment: what is run.
        starts: number of runs.
        on_period: called after each control period of each batch with the number of periods done and of all periods.

    Raises:
        InputError: the number of starts is none that can be run.
    """
    if not 1 <= starts <= MOST_STARTS:
        raise InputError(f"--starts: expected 1 to {MOST_STARTS}, got {starts}")
    together = max(1, BATCH_STATES // (experiment.n * count_periods(experiment)))
    reached = 0
    for first in range(0, starts, together):
        seeds = range(first, min(first + together, starts))
        runs = [simulate(experiment, seeds, _share_of(on_period, first, len(seeds), starts))]
        if not np.isfinite(runs[0].points[-1]).all():  # one that diverges ends a batch for all
            runs = [simulate(experiment, seed) for seed in seeds]
        reached += sum(int((judged_end(experiment, run) < experiment.goal).sum()) for run in runs)
    return reached / starts


def _share_of(on_period: Progress, done: int, runs: int, total: int) -> Progress:
    """The progress of some ``runs`` after ``done`` of ``total``, told as progress of them all."""
    return lambda period, periods: on_period(done * periods + runs * period, total * periods)
