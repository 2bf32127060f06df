"""Monte Carlo: one scenario or its variations, many seeds, one row per run, and what the rows say together."""

# Longer than 300 lines: a row, its study and their summary are one idea.

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.definition.experiment import Experiment, build, open_experiment
from scenarios.definition.load import ScenarioFile
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import count_periods, simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import write_json
from scenarios.studies.variations import Variation, combinations
from scenarios.work.protocol import Spread

ROWS, PARTIAL, SUMMARY = "rows.csv", "rows.partial.csv", "summary.json"
"""Files of a sweep; the rows are partial until the last run is done."""

SINGLE = "pymunk"
"""The plant that holds one run; the others advance a batch of runs as one array."""

BATCH_STATES = 1_000_000
"""Robots times control periods that advance as one array: some 60 MB of states."""

MOST_BATCHED = 100
"""Runs in one batch; more are no faster and make progress coarse."""

RUN_COLUMNS = 3
"""The first columns of a row, which tell the run."""

QUANTILES = (0.0, 0.05, 0.5, 0.95, 1.0)

Z_95 = 1.959963984540054
"""Standard normal quantile of a two-sided 95 % interval."""


@dataclass(frozen=True)
class Row:
    """One run; the columns of ``rows.csv``, varied keys after the seed. Empty cells stand for what did not happen."""

    scenario: str
    plant: str
    seed: int
    outcome: str
    angle_error_sum_rad: float | None
    axle_angle_error_sum_rad: float | None
    settling_time_s: float | None
    min_separation_m: float | None
    accepted: bool
    violations: str


@dataclass(frozen=True)
class Combination:
    """One value of each varied key, and the scenario that this makes.

    Attributes:
        changes: ``key=value`` texts, one per varied key.
        values: the values alone, as they were written.
        file: the scenario with all changes: runs need no file.
        batch_size: runs that are made together.
    """

    changes: tuple[str, ...]
    values: tuple[str, ...]
    file: ScenarioFile
    batch_size: int


@dataclass(frozen=True)
class Study:
    """What a sweep runs: every seed of every combination, a single combination where nothing is varied."""

    changes: tuple[str, ...]
    variations: tuple[Variation, ...]
    combinations: tuple[Combination, ...]
    seeds: range

    @property
    def runs(self) -> int:
        """Their number."""
        return len(self.combinations) * len(self.seeds)

    @property
    def default_folder(self) -> Path:
        """Where the sweep goes when no folder is named."""
        file, varied = self.combinations[0].file, [variation.key for variation in self.variations]
        plant = [] if "plant.name" in varied else [file.scenario.plant.name]
        parts = ["sweep", file.name, *plant, *varied, f"seeds{self.seeds[0]}-{self.seeds[-1]}"]
        return Path("runs") / "-".join(parts)

    def batches(self) -> list[Batch]:
        """All runs, in the order of the combinations and of the seeds."""
        return [
            Batch(c, tuple(self.seeds[i : i + c.batch_size]))
            for c in self.combinations
            for i in range(0, len(self.seeds), c.batch_size)
        ]


@dataclass(frozen=True)
class Batch:
    """Runs that are made together."""

    combination: Combination
    seeds: tuple[int, ...]

    def __str__(self) -> str:
        first, last = self.seeds[0], self.seeds[-1]
        seeds = f"seed {first}" if first == last else f"seeds {first} to {last}"
        return ", ".join([self.combination.file.name, *self.combination.changes, seeds])


@dataclass(frozen=True)
class Share:
    """A share of the runs with its 95 % interval (Wilson 1927)."""

    share: float
    low: float
    high: float

    @classmethod
    def of(cls, count: int, total: int) -> Share:
        """The share of ``count`` among ``total`` > 0 runs.

        >>> Share.of(100, 100).low > 0.96
        True
        """
        p, z = count / total, Z_95**2 / total
        centre, half = p + z / 2.0, np.sqrt(z * (p * (1.0 - p) + z / 4.0))
        return cls(p, max(0.0, float(centre - half) / (1.0 + z)), min(1.0, float(centre + half) / (1.0 + z)))


@dataclass(frozen=True)
class Summary:
    """What the rows say together.

    Attributes:
        runs: their number.
        converged, accepted: shares of the runs.
        missed: seeds of the runs that did not converge.
        quantiles: at :data:`QUANTILES`, by column; of the runs that have one; None where none has.
    """

    runs: int
    converged: Share
    accepted: Share
    missed: tuple[int, ...]
    quantiles: dict[str, tuple[float, ...] | None]


def parse_seeds(text: str) -> range:
    """The seeds A to B - 1 of ``A:B``.

    Raises:
        InputError: that is not a range of seeds, or an empty one.

    >>> parse_seeds("10:13")
    range(10, 13)
    """
    match = re.fullmatch(r"(\d{1,18}):(\d{1,18})", text.strip())
    if match is None or not int(match[1]) < int(match[2]):
        raise InputError(f"--seeds {text[:40]}: expected A:B with 0 <= A < B, the seeds A to B - 1")
    return range(int(match[1]), int(match[2]))


def open_study(source: str, changes: tuple[str, ...], variations: Sequence[Variation], seeds: range) -> Study:
    """Everything that a sweep needs, proved usable before anything runs.

    Args:
        source: the scenario's library name or path.
        changes: ``key=value`` texts, as with ``--set``.
        variations: keys that take several values.
        seeds: one run each, of every combination.

    Raises:
        InputError: the scenario cannot be used, with a combination of values at least.
    """
    found = []
    for values in combinations(variations):
        varied = tuple(f"{variation.key}={value}" for variation, value in zip(variations, values, strict=True))
        experiment = open_experiment(source, (*changes, *varied))
        experiment.initial_points(seeds[0])
        found.append(Combination(varied, values, experiment.file, batch_size(experiment)))
    return Study(changes, tuple(variations), tuple(found), seeds)


def sweep(
    study: Study, out: Path | None, run_all: Spread, on_progress: Callable[[int, int], None]
) -> tuple[list[Summary], Path]:
    """Run every seed and write one row per run, in order, each as soon as it is there.

    Args:
        study: what to run.
        out: folder of the files; None for the default.
        run_all: what makes the runs. The rows do not depend on it.
        on_progress: called with the number of runs done and of all runs.

    Returns:
        The summary of each combination, and the folder that they were written to.

    Raises:
        InputError: the folder cannot be written, or a run cannot be made.
    """
    folder = out or study.default_folder
    batches, keys = study.batches(), [variation.key for variation in study.variations]
    rows: list[Row] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / PARTIAL).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(_with_varied([field.name for field in fields(Row)], keys))
            for batch, finished in zip(batches, run_all(run_batch, batches), strict=True):
                values = batch.combination.values
                writer.writerows(_with_varied(list(asdict(row).values()), values) for row in finished)
                file.flush()
                rows += finished
                on_progress(len(rows), study.runs)
        (folder / PARTIAL).replace(folder / ROWS)
        size = len(study.seeds)
        summaries = [summarise(rows[i : i + size]) for i in range(0, len(rows), size)]
        write_json(folder / SUMMARY, _summary_file(study, summaries))
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from error
    return summaries, folder


def _with_varied(cells: list[Any], varied: Sequence[str]) -> list[Any]:
    """What tells the run comes before what it gave."""
    return [*cells[:RUN_COLUMNS], *varied, *cells[RUN_COLUMNS:]]


def _summary_file(study: Study, summaries: Sequence[Summary]) -> dict[str, Any]:
    """The content of ``summary.json``."""
    content = {"changes": list(study.changes), "quantiles_at": QUANTILES}
    if not study.variations:
        return {"scenario_sha256": study.combinations[0].file.sha256, **content, **asdict(summaries[0])}
    return {
        **content,
        "varied": {variation.key: variation.values for variation in study.variations},
        "combinations": [
            {"changes": combination.changes, "scenario_sha256": combination.file.sha256, **asdict(summary)}
            for combination, summary in zip(study.combinations, summaries, strict=True)
        ],
    }


def batch_size(experiment: Experiment) -> int:
    """Runs that are made together: many on a plant without contact, one on pymunk."""
    if experiment.plant == SINGLE:
        return 1
    states = experiment.n * count_periods(experiment)
    return max(1, min(MOST_BATCHED, BATCH_STATES // states))


def run_batch(batch: Batch) -> list[Row]:
    """The rows of a batch."""
    experiment = build(batch.combination.file)
    return [_row(experiment, seed, run) for seed, run in zip(batch.seeds, _runs(experiment, batch.seeds), strict=True)]


def _runs(experiment: Experiment, seeds: Sequence[int]) -> Iterator[Trajectory]:
    if len(seeds) > 1:
        together = simulate(experiment, seeds)
        if np.isfinite(together.poses[-1]).all():
            yield from (together.run(index) for index in range(len(seeds)))
            return
    # One by one; also where a run of the batch diverged, which ended it for all.
    yield from (simulate(experiment, seed) for seed in seeds)


def _row(experiment: Experiment, seed: int, trajectory: Trajectory) -> Row:
    metrics = measure(experiment, trajectory)
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
        violations=" ".join(violation.kind for violation in metrics.verdict.violations),
    )


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def summarise(rows: Sequence[Row]) -> Summary:
    """The summary of at least one row."""
    quantiles = {}
    for column in ("settling_time_s", "angle_error_sum_rad", "min_separation_m"):
        values = np.array([value for row in rows if (value := getattr(row, column)) is not None])
        quantiles[column] = tuple(np.quantile(values, QUANTILES).tolist()) if values.size else None
    return Summary(
        runs=len(rows),
        converged=Share.of(sum(row.outcome == "converged" for row in rows), len(rows)),
        accepted=Share.of(sum(row.accepted for row in rows), len(rows)),
        missed=tuple(row.seed for row in rows if row.outcome != "converged"),
        quantiles=quantiles,
    )
