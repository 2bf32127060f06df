"""One run of a sweep: made, measured, and told in one row."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, get_type_hints

import numpy as np

from scenarios.definition.experiment import Experiment, build
from scenarios.errors import InputError
from scenarios.measures.clearance import Clearance
from scenarios.measures.metrics import measure
from scenarios.measures.online.watch import Achieved, Watch
from scenarios.measures.window import Window
from scenarios.simulation.compiled.runs import Runs
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.studies.sweep.cause import ERROR, Ends, cause_of
from scenarios.studies.sweep.study import Batch, is_watched, together

RUN_COLUMNS = 3
"""The first columns of a row, which tell the run; varied keys come behind them."""

FAILED = "failed"
"""The outcome of a run that could not be made to its end."""

PERIODS = 16
"""Control periods between two looks at compiled runs: their states then still lie in the processor's cache."""

LONGEST_MESSAGE = 300
"""Characters of what went wrong."""


@dataclass(frozen=True)
class Row:
    """One run; the columns of ``rows.csv``, varied keys after the seed. Empty cells stand for what did not happen."""

    scenario: str
    plant: str
    seed: int
    outcome: str
    angle_error_sum_rad: float | None = None
    axle_angle_error_sum_rad: float | None = None
    settling_time_s: float | None = None
    min_separation_m: float | None = None
    accepted: bool | None = None
    violations: str = ""
    mean_angle_error_sum_rad: float | None = None
    rms_angle_error_sum_rad: float | None = None
    mean_errors_rad: str = ""
    rms_errors_rad: str = ""
    min_clearance_m: float | None = None
    min_hull_clearance_m: float | None = None
    cause: str = ""
    message: str = ""

    @classmethod
    def read(cls, cells: Mapping[str, str]) -> Row:
        """The row that stands in ``rows.csv`` with these cells.

        Raises:
            ValueError, KeyError: they are none.
        """
        return cls(**{name: kind(cells[name]) for name, kind in _READ.items()})

    def cells(self, varied: Sequence[str]) -> list[Any]:
        """The row as it is written."""
        return _with_varied([getattr(self, name) for name in NAMES], varied)


NAMES = tuple(field.name for field in fields(Row))


def _number(cell: str) -> float | None:
    return float(cell) if cell else None


def _truth(cell: str) -> bool | None:
    return {"": None, "True": True, "False": False}[cell]


_READERS: dict[Any, Callable[[str], Any]] = {str: str, int: int, float | None: _number, bool | None: _truth}
_READ = {name: _READERS[kind] for name, kind in get_type_hints(Row).items()}


def columns(varied: Sequence[str]) -> list[str]:
    """The names above the rows."""
    return _with_varied(list(NAMES), varied)


def _with_varied(cells: list[Any], varied: Sequence[str]) -> list[Any]:
    return [*cells[:RUN_COLUMNS], *varied, *cells[RUN_COLUMNS:]]


def run_batch(batch: Batch) -> list[Row]:
    """The rows of a batch. A run that cannot be made has its row too, and the others go on."""
    try:
        experiment = build(batch.combination.file, batch.combination.duration)
    except Exception as error:
        return [_failed(batch, seed, error) for seed in batch.seeds]
    if is_watched(experiment):
        step = together(experiment)
        parts = [batch.seeds[first : first + step] for first in range(0, len(batch.seeds), step)]
        return [row for seeds in parts for row in _watched(batch, experiment, seeds)]
    states = _together(experiment, batch.seeds) if len(batch.seeds) > 1 else None
    return [
        _alone(batch, experiment, seed, None if states is None else states.run(index))
        for index, seed in enumerate(batch.seeds)
    ]


def _alone(batch: Batch, experiment: Experiment, seed: int, trajectory: Trajectory | None = None) -> Row:
    """The row of a run that is measured by itself, and made where there is no trajectory."""
    try:
        return _row(experiment, seed, simulate(experiment, seed) if trajectory is None else trajectory)
    except Exception as error:
        return _failed(batch, seed, error)


def _watched(batch: Batch, experiment: Experiment, seeds: Sequence[int]) -> Iterator[Row]:
    """The rows of compiled runs, measured on their way; those whose states do not tell are made by themselves."""
    from robots.worlds.lanes import PX, PY, STUCK, UX, UY

    try:
        runs = Runs(experiment, seeds)
        starts = runs.state[PX : PY + 1].T.copy()
        watch = Watch(experiment, runs.state)
        for chunk in runs.advance(PERIODS):
            watch.take(chunk)
        achieved = watch.achieved()
    except Exception:  # made one by one, the runs tell which of them it was
        yield from (_alone(batch, experiment, seed) for seed in seeds)
        return
    for m, (seed, found) in enumerate(zip(seeds, achieved, strict=True)):
        if found is None:
            yield _alone(batch, experiment, seed)
        else:
            yield _told(
                experiment, seed, found, Ends(starts[m], runs.state[STUCK, :, m], runs.state[UX : UY + 1, :, m].T)
            )


def _told(experiment: Experiment, seed: int, achieved: Achieved, ends: Ends) -> Row:
    """The row of a run that was watched."""
    return Row(
        scenario=experiment.file.name,
        plant=experiment.plant,
        seed=seed,
        outcome=achieved.outcome,
        angle_error_sum_rad=_finite(achieved.error_sum),
        axle_angle_error_sum_rad=_finite(achieved.axle_error_sum),
        settling_time_s=achieved.settling_time,
        min_separation_m=_finite(achieved.separation),
        accepted=achieved.accepted,
        violations=" ".join(achieved.violations),
        cause=cause_of(experiment, achieved.outcome, achieved.violations, ends),
    )


def _together(experiment: Experiment, seeds: Sequence[int]) -> Trajectory | None:
    """All runs as one array; None where one of them diverged or failed, which ended it for all."""
    try:
        states = simulate(experiment, seeds)
    except Exception:  # made one by one, the runs tell which of them it was
        return None
    return states if np.isfinite(states.poses[-1]).all() else None


def _row(experiment: Experiment, seed: int, trajectory: Trajectory) -> Row:
    metrics = measure(experiment, trajectory)
    violations = [violation.kind for violation in metrics.verdict.violations]
    return Row(
        scenario=experiment.file.name,
        plant=experiment.plant,
        seed=seed,
        outcome=metrics.outcome,
        angle_error_sum_rad=_finite(metrics.error_sum[-1]),
        axle_angle_error_sum_rad=_finite(metrics.axle_error_sum[-1]),
        settling_time_s=metrics.settling_time,
        min_separation_m=_finite(metrics.separation.distance.min()),
        accepted=metrics.verdict.accepted,
        violations=" ".join(violations),
        cause=cause_of(experiment, metrics.outcome, violations, Ends.of(trajectory)),
        **({} if metrics.window is None else _over_window(metrics.window)),
        **({} if metrics.clearance is None else _clearances(metrics.clearance)),
    )


def _clearances(clearance: Clearance) -> dict[str, Any]:
    """The columns that only a floor with walls or obstacles fills."""
    points, hulls = clearance.points, clearance.hulls
    return {
        "min_clearance_m": _finite(points.distance[points.lowest]),
        "min_hull_clearance_m": None if hulls is None else _finite(hulls.distance[hulls.lowest]),
    }


def _over_window(window: Window) -> dict[str, Any]:
    """The columns that only noisy sensors fill: sums over the angles, and each angle's own, in their order."""
    mean, rms = window.mean[-1], window.rms[-1]
    return {
        "mean_angle_error_sum_rad": _finite(np.abs(mean).sum()),
        "rms_angle_error_sum_rad": _finite(rms.sum()),
        "mean_errors_rad": " ".join(map(repr, mean.tolist())),
        "rms_errors_rad": " ".join(map(repr, rms.tolist())),
    }


def _failed(batch: Batch, seed: int, error: Exception) -> Row:
    """The row of a run that raised: what, on one line of printable characters."""
    said = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
    line = "".join(c if c.isprintable() else "?" for c in " ".join(said.split()))
    file = batch.combination.file
    return Row(file.name, file.scenario.plant.name, seed, FAILED, cause=ERROR, message=line[:LONGEST_MESSAGE])


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
