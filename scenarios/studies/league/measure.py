"""What is measured of each row: shares from random starts and from near, with compass errors, with noise, on robots."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from formation.analysis.flow import Flow
from robots import Imperfections
from scenarios.definition.bounds import MOST_STARTS
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.simulation.loop import simulate
from scenarios.studies.league.ends import ENDS, RIGHT, TOLERANCE, ends, residual
from scenarios.studies.league.entries import Entry, Player, on_robots, player
from scenarios.studies.league.ideal import NEAR, near_starts, random_starts, run

Real = NDArray[np.float64]
Progress = Callable[[int, int], None]

COMPASS_DEG = 5.0
"""Standard deviation of the constant compass errors."""

DRAWS = 300
"""Draws of compass errors."""

NOISE = Imperfections(position=0.01, bearing=np.radians(1.0), distance=0.01, angle=np.radians(1.0), ratio=0.05)
"""On robots with noise: 1 cm, 1 degree, 5 %."""

AS_GIVEN = ('law.name="angle"', 'graph="given"')
"""Settings with which every scenario is opened, whatever its own law: each row then builds its graph."""

PLANTS = ("unicycle", "saturated", "pymunk")
"""Plants with wheels."""

QUANTILES = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Compass:
    """What compass errors do to a law that needs a compass.

    Attributes:
        right: share that is right all the same.
        residual: median of the residual at the end.
        drift: speed of the formation's centre, m/s, at the end: the quantiles of :data:`QUANTILES`.
    """

    right: float
    residual: float
    drift: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Row:
    """All of one row.

    Attributes:
        entry: who.
        edges: number of sensing edges.
        player: the law with its graph; None where it cannot be made for the target.
        refused: why not.
        counts: of each kind of end, from random starts.
        settling: median seconds of the right ones, None without any.
        near: share right from near the target, for each of :data:`NEAR`.
        compass: None for a law without a compass.
        noise: median residual at the end with noise on ``saturated``.
        plants: how many of the robots' runs are right, by plant.
        starts, ends: of the first random runs, for the figure.
    """

    entry: Entry
    player: Player | None
    refused: str = ""
    counts: tuple[int, ...] = (0,) * len(ENDS)
    settling: float | None = None
    near: tuple[float, ...] = ()
    compass: Compass | None = None
    noise: float | None = None
    plants: tuple[int, ...] = ()
    starts: Real | None = None
    flow: Flow | None = None

    @property
    def runs(self) -> int:
        """Number of random starts."""
        return sum(self.counts)

    @property
    def share(self) -> float:
        """That reaches the right shape."""
        return self.counts[ENDS.index(RIGHT)] / self.runs


def league(
    scenario: str,
    changes: tuple[str, ...],
    rows: Sequence[Entry],
    starts: int,
    robots: int,
    on_progress: Progress,
) -> list[Row]:
    """Measure every row on the target of a scenario.

    Args:
        scenario: name or path.
        changes: ``key=value`` texts, as with ``--set``.
        rows: who takes part.
        starts: random starts of ideal integrators.
        robots: seeds on each plant with wheels; 0 for none.
        on_progress: called with the number of steps done and of all.

    Raises:
        InputError: the scenario cannot be used, or the number of starts is none that can be run.
    """
    if not 1 <= starts <= MOST_STARTS:
        raise InputError(f"--starts: expected 1 to {MOST_STARTS}, got {starts}")
    experiment = open_experiment(scenario, (*changes, *AS_GIVEN))
    done = []
    for number, entry in enumerate(rows):
        done.append(measure(experiment, (scenario, changes), entry, starts, robots))
        on_progress(number + 1, len(rows))
    return done


def measure(experiment: Experiment, source: tuple[str, tuple[str, ...]], entry: Entry, starts: int, robots: int) -> Row:
    """One row; see :func:`league`."""
    try:
        one = player(entry, experiment.formation)
    except ValueError as error:
        return Row(entry, None, str(error))
    places = random_starts(one, starts)
    found = run(one, places, entry.horizon)
    kinds = ends(one.formation, found)
    right = np.isfinite(found.settled)
    near = [run(one, near_starts(one, min(starts, DRAWS), sigma), entry.horizon) for sigma in NEAR]
    return Row(
        entry,
        one,
        counts=tuple(int((kinds == kind).sum()) for kind in range(len(ENDS))),
        settling=float(np.median(found.settled[right])) if right.any() else None,
        near=tuple(float(np.isfinite(each.settled).mean()) for each in near),
        compass=_compass(one, min(starts, DRAWS)) if one.law.needs_compass else None,
        noise=_noise(source, one, robots),
        plants=tuple(_reached(source, one, plant, robots) for plant in PLANTS) if robots else (),
        starts=places,
        flow=found,
    )


def _compass(one: Player, draws: int) -> Compass:
    errors = np.random.default_rng(1).normal(0.0, np.radians(COMPASS_DEG), (draws, one.formation.graph.n))
    found = run(one, random_starts(one, draws), one.entry.horizon, errors)
    drift = np.quantile(found.drift, QUANTILES)
    distance = residual(one.formation, found.points)
    return Compass(float((distance < TOLERANCE).mean()), float(np.median(distance)), tuple(drift.tolist()))


def robots_of(source: tuple[str, tuple[str, ...]], one: Player, plant: str) -> Experiment | None:
    """The scenario's robots with a row's law on a plant, until the row's horizon; None where they are not as many."""
    scenario, changes = source
    settings = (*AS_GIVEN, f"plant.name={plant}", "sensor.delay_periods=0")
    experiment = open_experiment(scenario, (*changes, *settings), min(one.entry.horizon, 120.0))
    return None if one.formation.graph.n != experiment.n else on_robots(experiment, one)


@np.errstate(all="ignore")
def _reached(source: tuple[str, tuple[str, ...]], one: Player, plant: str, seeds: int) -> int:
    experiment = robots_of(source, one, plant)
    if experiment is None:
        return 0
    ended = [simulate(experiment, seed).points[-1] for seed in range(seeds)]
    return int((residual(one.formation, np.stack(ended)) < TOLERANCE).sum())


@np.errstate(all="ignore")
def _noise(source: tuple[str, tuple[str, ...]], one: Player, seeds: int) -> float | None:
    noisy = robots_of(source, one, "saturated") if seeds else None
    if noisy is None:
        return None
    instruments = type(noisy.instruments)(
        one.formation.graph.edges, one.formation.graph.corners, one.law.measures, NOISE
    )
    noisy = replace(noisy, instruments=instruments)
    ended = np.stack([simulate(noisy, seed).points[-300:] for seed in range(min(seeds, 5))])
    return float(np.median(residual(one.formation, ended)))
