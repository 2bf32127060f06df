"""The laws side by side: what each measures and needs, and how often it reaches the right shape from random starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

import numpy as np
from rich.console import Console

from scenarios.definition.bounds import MOST_STARTS
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.documents import markdown_table
from scenarios.errors import InputError
from scenarios.measures.metrics import judged_end
from scenarios.simulation.loop import count_periods, simulate
from scenarios.terminal import new_table, print_table

Progress = Callable[[int, int], None]
"""Called with the number of control periods done and of all."""

SCENARIO = "law-displacement"
"""The comparison's robots: its target has a scale and an orientation, so every family can be asked for it."""

DURATION = 120.0
"""Seconds; long enough for the slowest law, so that a miss is a wrong equilibrium."""

BATCH_STATES = 5_000_000
"""Robots times control periods that advance as one array: half a GB of states, however many starts there are."""

COMPASS_BIAS_DEG = 5.0
"""Standard deviation of the compass errors in the second column of shares."""

COLUMNS = ("law", "measures", "frame", "fixes", "right shape", f"with {COMPASS_BIAS_DEG:g} deg compass error")

RANDOM_START = ("random_start.x_m=[-1.4, 1.4]", "random_start.y_m=[-0.8, 0.8]")
"""Where all laws start, as changes of a scenario."""


@dataclass(frozen=True)
class Law:
    """One row of the comparison."""

    name: str
    measures: str
    frame: str
    fixes: str


LAWS = (
    Law("angle", "relative positions", "any local frame", "shape"),
    Law("displacement", "relative positions", "common (compass)", "shape, scale, orientation"),
    Law("bearing", "bearings", "common (compass)", "shape, orientation"),
    Law("distance", "relative positions", "any local frame", "distances along edges"),
)


@dataclass(frozen=True)
class Share:
    """How often a law reached the right shape.

    Attributes:
        law: the row.
        exact, biased: share of the starts with an angle error sum below the scenario's goal at the end, with exact
            compasses and with biased ones.
    """

    law: Law
    exact: float
    biased: float


def compare(starts: int, on_progress: Progress | None = None) -> list[Share]:
    """Run every law from the same ``starts`` random starts as ideal single integrators."""
    cells = [(law, bias) for law in LAWS for bias in (0.0, COMPASS_BIAS_DEG)]
    shares = []
    for done, (law, bias) in enumerate(cells):
        shares.append(_share(law, bias, starts, part_of(on_progress or _unwatched, done, len(cells))))
    return [Share(law, *pair) for law, pair in zip(LAWS, zip(shares[::2], shares[1::2], strict=True), strict=True)]


def part_of(on_progress: Progress, done: int, parts: int) -> Progress:
    """The progress of one of equal ``parts``, after ``done`` of them, told as progress of the whole."""
    return lambda period, periods: on_progress(done * periods + period, parts * periods)


def _unwatched(done: int, total: int) -> None:
    """Nobody looks."""


def _share(law: Law, bias: float, starts: int, advance: Progress) -> float:
    changes = (
        f"law.name={law.name}",
        f"sensor.compass_bias_deg={bias}",
        "plant.name=single_integrator",
        *RANDOM_START,
    )
    return share_reaching(open_experiment(SCENARIO, changes, DURATION), starts, advance)


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


def print_laws(console: Console, shares: Sequence[Share]) -> None:
    """The comparison as a table."""
    table = new_table(*COLUMNS)
    for row in rows(shares):
        table.add_row(*row)
    print_table(console, table)


def markdown(shares: Sequence[Share], starts: int) -> str:
    """The comparison as a Markdown page."""
    lines = ["# The laws side by side", "", "Written by `formation laws --markdown docs/laws.md`.", ""]
    lines += markdown_table(COLUMNS, rows(shares), numbers=2)
    lines += ["", f"{starts} random starts each, ideal single integrators, {DURATION:g} s."]
    return "\n".join(lines) + "\n"


def rows(shares: Sequence[Share]) -> list[tuple[str, ...]]:
    """The cells of each law, below :data:`COLUMNS`."""
    return [(*astuple(share.law), f"{share.exact:.1%}", f"{share.biased:.1%}") for share in shares]
