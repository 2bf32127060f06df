"""What a sweep runs: every seed of every combination of the varied values, in an order that never changes."""

from __future__ import annotations

import hashlib
import json
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from scenarios.definition.experiment import Experiment, open_experiment, require_safety
from scenarios.definition.load import ScenarioFile
from scenarios.errors import InputError
from scenarios.measures.online.watch import watchable
from scenarios.measures.result import versions
from scenarios.simulation.compiled.ability import side_by_side, unable
from scenarios.simulation.schedule import count_periods
from scenarios.studies.project import PROJECT
from scenarios.studies.sweep.seeds import Seeds
from scenarios.studies.sweep.variations import Variation, combinations

SINGLE = "pymunk"
"""The plant that holds one run; the others advance a batch of runs as one array."""

BATCH_STATES = 1_000_000
"""Robots times control periods that advance as one array: some 60 MB of states."""

LANES = 1584
"""Robots of compiled runs that advance side by side, run by run: 264 runs of six. Rows of a state a power of two apart
would share lines of the cache."""

MOST_BATCHED = 100
"""Runs whose states are kept in one batch; more are no faster and make progress coarse."""

MOST_WATCHED = 1000
"""Runs in one batch of those that are measured on their way, some at a time side by side."""

WATCHED_STATES = 8_000_000
"""Robots times control periods in such a batch: a fraction of a second."""

WATCHED_STATES_IN_CONTACT = 100_000
"""The same on pymunk."""


@dataclass(frozen=True)
class Combination:
    """One value of each varied key, and the scenario that this makes.

    Attributes:
        changes: ``key=value`` texts, one per varied key.
        values: the values alone, as they were written.
        file: the scenario with all changes: runs need no file.
        safety: the filter of its runs.
        batch_size: runs that are one task.
        duration: seconds to run, where it is not the scenario's own.
    """

    changes: tuple[str, ...]
    values: tuple[str, ...]
    file: ScenarioFile
    safety: str
    batch_size: int
    duration: float | None = None


@dataclass(frozen=True)
class Batch:
    """Runs that are one task."""

    combination: Combination
    seeds: tuple[int, ...]

    def __str__(self) -> str:
        first, last = self.seeds[0], self.seeds[-1]
        seeds = f"seed {first}" if first == last else f"seeds {first} to {last}"
        return ", ".join([self.combination.file.name, *self.combination.changes, seeds])


@dataclass(frozen=True)
class Study:
    """What a sweep runs: every seed of every combination, a single combination where nothing is varied."""

    changes: tuple[str, ...]
    variations: tuple[Variation, ...]
    combinations: tuple[Combination, ...]
    seeds: Seeds
    duration: float | None = None

    @property
    def runs(self) -> int:
        """Their number."""
        return len(self.combinations) * self.seeds.count

    @property
    def default_folder(self) -> Path:
        """Where the sweep goes when no folder is named; what is changed or varied tells folders apart by a digest."""
        file, varied = self.combinations[0].file, [variation.key for variation in self.variations]
        plant = [] if "plant.name" in varied else [file.scenario.plant.name]
        changes = [change for change in self.changes if not change.startswith("plant.name=")]
        told = changes, [variation.values for variation in self.variations], self.duration, str(self.seeds)
        digest = hashlib.sha256(json.dumps(told).encode()).hexdigest()[:6]
        plain = not (changes or varied or self.duration) and len(self.seeds.parts) == 1
        parts = ["sweep", file.name, *plant, *varied, f"seeds{self.seeds.in_a_name}", *([] if plain else [digest])]
        return Path("runs") / "-".join(parts)

    def batches(self, done: int = 0) -> Iterator[Batch]:
        """The runs behind the first ``done``, which are whole batches; in order, and made as they are asked for."""
        finished, within = divmod(done, self.seeds.count)
        for combination in self.combinations[finished:]:
            seeds = self.seeds.after(within)
            while batch := tuple(islice(seeds, combination.batch_size)):
                yield Batch(combination, batch)
            within = 0

    def command(self, combination: Combination, seed: int) -> str:
        """What makes one of the runs again, with its recording."""
        changes = [text for change in (*self.changes, *combination.changes) for text in ("--set", change)]
        length = [] if self.duration is None else ["--duration", f"{self.duration:.15g}"]
        return shlex.join(["formation", "run", combination.file.path, "--seed", str(seed), *length, *changes])

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """All that the rows depend on: two studies with one manifest have the same rows, bit for bit."""
        from scenarios.work.cluster import sources  # loads asyncio

        return {
            "schema_version": 1,
            "scenario": self.combinations[0].file.name,
            "seeds": str(self.seeds),
            "duration_s": self.duration,
            "changes": list(self.changes),
            "varied": {variation.key: list(variation.values) for variation in self.variations},
            "plant": [combination.file.scenario.plant.name for combination in self.combinations],
            "safety": [combination.safety for combination in self.combinations],
            "scenario_sha256": [combination.file.sha256 for combination in self.combinations],
            "versions": versions(),
            "sources_sha256": sources(PROJECT.packages),
        }


def open_study(
    source: str,
    changes: tuple[str, ...],
    variations: Sequence[Variation],
    seeds: Seeds,
    duration: float | None = None,
    safety: str | None = None,
) -> Study:
    """Everything that a sweep needs, proved usable before anything runs.

    Args:
        source: the scenario's library name or path.
        changes: ``key=value`` texts, as with ``--set``.
        variations: keys that take several values.
        seeds: one run each, of every combination.
        duration: seconds to run instead of the scenario's own.
        safety: the filter that every combination must have; None where the scenario decides.

    Raises:
        InputError: the scenario cannot be used, with a combination of values at least.
    """
    found = []
    for values in combinations(variations):
        varied = tuple(f"{variation.key}={value}" for variation, value in zip(variations, values, strict=True))
        try:
            experiment = open_experiment(source, (*changes, *varied), duration)
        except InputError as error:
            raise InputError(_as_varied(str(error), variations)) from error
        require_safety(experiment, safety)
        try:
            experiment.initial_points(seeds.first)
        except InputError as error:
            raise InputError(f"{error} (seed {seeds.first})") from error
        found.append(Combination(varied, values, experiment.file, experiment.safety, batch_size(experiment), duration))
    return Study(changes, tuple(variations), tuple(found), seeds, duration)


def _as_varied(message: str, variations: Sequence[Variation]) -> str:
    """What a scenario says of its changes, with the option that made this one."""
    varied = tuple(f"--set {variation.key}=" for variation in variations)
    return message.replace("--set", "--vary", 1) if message.startswith(varied) else message


def batch_size(experiment: Experiment) -> int:
    """Runs that are one task."""
    step = together(experiment)
    if not is_watched(experiment):
        return step
    states = WATCHED_STATES_IN_CONTACT if experiment.plant == SINGLE else WATCHED_STATES
    passes = states // (step * experiment.n * count_periods(experiment))
    return min(MOST_WATCHED, step * max(1, passes))


def together(experiment: Experiment) -> int:
    """Runs that advance together: many on a plant without contact, as far as memory and cache go, one on pymunk."""
    if experiment.plant == SINGLE:
        return 1
    if is_watched(experiment):
        return max(1, LANES // experiment.n) if side_by_side(experiment) else 1
    states = experiment.n * count_periods(experiment)
    return max(1, min(MOST_BATCHED, BATCH_STATES // states))


def is_watched(experiment: Experiment) -> bool:
    """Whether its runs are measured on their way."""
    return unable(experiment) is None and watchable(experiment)
