"""The ladder: one scenario on five rungs, from the theorem's points to robots as logs and firmware show them.

Each rung brings what the one below leaves out: single_integrator is the theory, unicycle adds the map to two wheels,
saturated the wheels' limits, pymunk mass and contact, measured the real robot.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.markup import escape

from scenarios.definition.experiment import Experiment, build, open_experiment
from scenarios.definition.load import ScenarioFile
from scenarios.documents import cell, markdown_table
from scenarios.measures.metrics import measure, settling_time
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import write_whole
from scenarios.studies.sweep.study import together
from scenarios.studies.sweep.summary import Share
from scenarios.terminal import new_table, print_table
from scenarios.work.protocol import Spread

Real = NDArray[np.float64]

RUNGS = (
    ("single_integrator", ("plant.name=single_integrator",), "the theory"),
    ("unicycle", ("plant.name=unicycle",), "the map"),
    ("saturated", ("plant.name=saturated",), "the wheels"),
    ("pymunk", ("plant.name=pymunk",), "the contacts"),
    ("measured", ("plant.name=pymunk", "robot.model=measured"), "the real robot"),
)
"""Each rung by name, with the changes that make it and what it adds."""

FLOOR_S = 5.0
"""Seconds at the end of a run whose median error is its floor."""

NEAR = 0.05
"""Radians: an error sum of six robots that a person would call the shape; every rung gets there."""

SAMPLES = 240
"""Times of a run at which the figure knows its error."""

ROWS = "rows.csv"


@dataclass(frozen=True)
class Row:
    """One run; the columns of ``rows.csv``.

    Attributes:
        rung: its name.
        seed: of the run.
        converged: whether it ends within the scenario's goal.
        settling_time_s: to the goal, None where it never settles.
        near_time_s: to :data:`NEAR`.
        floor_rad: median of the angle error sum over the last :data:`FLOOR_S`.
        closest_m: least distance of two collision centres; None without bodies.
        accepted: by the testbed.
    """

    rung: str
    seed: int
    converged: bool
    settling_time_s: float | None
    near_time_s: float | None
    floor_rad: float
    closest_m: float | None
    accepted: bool


@dataclass(frozen=True, eq=False)
class Ladder:
    """All runs of a ladder.

    Attributes:
        scenario: its name.
        rows: of all rungs, in order.
        times: (SAMPLES,) seconds.
        errors: by rung, (seeds, SAMPLES) angle error sums, radians.
    """

    scenario: str
    rows: tuple[Row, ...]
    times: Real
    errors: dict[str, Real]

    def of(self, rung: str) -> list[Row]:
        return [row for row in self.rows if row.rung == rung]


@dataclass(frozen=True)
class Batch:
    """Runs on one rung that are made together."""

    rung: str
    file: ScenarioFile
    seeds: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.file.name}, {self.rung}, seeds {self.seeds[0]} to {self.seeds[-1]}"


def climb(
    source: str,
    changes: tuple[str, ...],
    seeds: Sequence[int],
    run_all: Spread,
    on_progress: Callable[[int, int], None],
) -> Ladder:
    """Run every seed on every rung.

    Raises:
        InputError: the scenario cannot be used on a rung.
    """
    batches: list[Batch] = []
    for rung, added, _ in RUNGS:
        experiment = open_experiment(source, (*changes, *added))
        experiment.initial_points(seeds[0])
        step = together(experiment)
        batches += [Batch(rung, experiment.file, tuple(seeds[i : i + step])) for i in range(0, len(seeds), step)]
    rows: list[Row] = []
    errors: dict[str, list[Real]] = {rung: [] for rung, _, _ in RUNGS}
    for finished in run_all(run_batch, batches):
        for row, series in finished:
            rows.append(row)
            errors[row.rung].append(series)
        on_progress(len(rows), len(RUNGS) * len(seeds))
    stacked = {rung: np.stack(found) for rung, found in errors.items()}
    return Ladder(experiment.file.name, tuple(rows), sample_times(experiment), stacked)


def sample_times(experiment: Experiment) -> Real:
    """(SAMPLES,) seconds."""
    return np.linspace(0.0, sum(phase.duration for phase in experiment.phases), SAMPLES)


def run_batch(batch: Batch) -> list[tuple[Row, Real]]:
    """The rows of a batch, each with its angle error sums at :func:`sample_times`."""
    experiment = build(batch.file)
    together = simulate(experiment, batch.seeds) if len(batch.seeds) > 1 else None
    found = []
    for index, seed in enumerate(batch.seeds):
        if together is not None and np.isfinite(together.poses[-1]).all():
            trajectory = together.run(index)
        else:
            trajectory = simulate(experiment, seed)
        found.append(_row(experiment, batch.rung, seed, trajectory))
    return found


def _row(experiment: Experiment, rung: str, seed: int, trajectory: Trajectory) -> tuple[Row, Real]:
    metrics = measure(experiment, trajectory)
    t, errors = trajectory.t, metrics.error_sum
    closest = float(metrics.separation.distance.min())
    row = Row(
        rung=rung,
        seed=seed,
        converged=metrics.outcome == "converged",
        settling_time_s=metrics.settling_time,
        near_time_s=settling_time(t, errors, NEAR),
        floor_rad=float(np.median(errors[t >= t[-1] - FLOOR_S])),
        closest_m=closest if experiment.plant != RUNGS[0][0] and np.isfinite(closest) else None,
        accepted=metrics.verdict.accepted,
    )
    return row, np.interp(sample_times(experiment), t, errors)


def write_rows(ladder: Ladder, folder: Path) -> None:
    """Write ``rows.csv``.

    Raises:
        InputError: it cannot be written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Row)])
    writer.writerows(list(asdict(row).values()) for row in ladder.rows)
    write_whole(folder / ROWS, text.getvalue().encode())


COLUMNS = ("rung", "at goal", "accepted", "goal (s)", "near (s)", "floor (rad)", "least (m)")


def caption(ladder: Ladder) -> str:
    """What the columns are."""
    return (
        f"{len(ladder.of(RUNGS[0][0]))} seeds a rung; median times to the goal and to {NEAR} rad, median error of the "
        f"last {FLOOR_S:g} s, least distance of two collision centres"
    )


def lines(ladder: Ladder, intervals: bool) -> list[tuple[str, ...]]:
    """A line per rung; shares with their 95 % intervals where these are wanted."""
    found: list[tuple[str, ...]] = []
    for rung, _, _ in RUNGS:
        rows = ladder.of(rung)
        closest = [row.closest_m for row in rows if row.closest_m is not None]
        converged = Share.of(sum(row.converged for row in rows), len(rows))
        accepted = Share.of(sum(row.accepted for row in rows), len(rows))
        found.append(
            (
                rung,
                _share(converged, intervals),
                _share(accepted, intervals) if closest else "-",
                cell(_median([row.settling_time_s for row in rows]), ".1f"),
                cell(_median([row.near_time_s for row in rows]), ".1f"),
                f"{np.median([row.floor_rad for row in rows]):.1e}",
                cell(min(closest) if closest else None, ".3f"),
            )
        )
    return found


def print_ladder(console: Console, ladder: Ladder) -> None:
    """The ladder for a person."""
    table = new_table(*COLUMNS, title=escape(ladder.scenario))
    for line in lines(ladder, intervals=False):
        table.add_row(*line)
    print_table(console, table)
    console.print(caption(ladder))


def markdown(ladder: Ladder) -> list[str]:
    """The same table, for a page."""
    table = markdown_table(COLUMNS, lines(ladder, intervals=True), numbers=len(COLUMNS) - 1)
    return [f"{caption(ladder)}; shares with 95 % intervals.", "", *table]


def _share(share: Share, interval: bool) -> str:
    between = f" ({100.0 * share.low:.1f} to {100.0 * share.high:.1f} %)" if interval else ""
    return f"{100.0 * share.share:.1f} %{between}"


def _median(values: Sequence[float | None]) -> float | None:
    """The median, of all: None where half of them did not happen."""
    return float(found) if np.isfinite(found := np.median([np.inf if v is None else v for v in values])) else None
