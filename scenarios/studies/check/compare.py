"""A run beside its baseline: what differs, by how much, and whether that is too much."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from scenarios.studies.check.baseline import Run
from scenarios.studies.check.quantities import Measures, distance, is_angle


@dataclass(frozen=True)
class Difference:
    """One number or text of a run beside the baseline's.

    Attributes:
        name: of the number or text.
        expected, found: None for a number that did not happen or is not there.
        difference: in the number's unit; infinite where one is None or a text differs.
        tolerance: in the same unit.
    """

    name: str
    expected: float | str | None
    found: float | str | None
    difference: float
    tolerance: float

    @property
    def missed(self) -> bool:
        return not self.difference <= self.tolerance

    @property
    def rank(self) -> tuple[bool, float]:
        """Sorts the worst angle first, other things after the angles."""
        return not is_angle(self.name), -self.difference


@dataclass(frozen=True, eq=False)
class Comparison:
    """One run beside its baseline.

    Attributes:
        scenario: its name.
        source: the library name or path that opens it.
        run: the baseline's.
        differences: of every number and text.
        seconds: that the run took.
    """

    scenario: str
    source: str
    run: Run
    differences: tuple[Difference, ...]
    seconds: float

    @property
    def misses(self) -> list[Difference]:
        """What is off by more than its tolerance, the worst angle first."""
        return sorted((d for d in self.differences if d.missed), key=lambda d: d.rank)

    @property
    def command(self) -> str:
        """The command that makes this run."""
        changes = "".join(f" --set '{change}'" for change in self.run.changes)
        return f"formation run {self.source} --plant {self.run.plant} --seed {self.run.seed}{changes}"

    def worst(self, suffix: str) -> float | None:
        """The largest difference of the numbers whose names end so; None if there are none."""
        return max((d.difference for d in self.differences if d.name.endswith(suffix)), default=None)


def compare(run: Run, found: Measures, exact: bool) -> tuple[Difference, ...]:
    """What a run gave beside what its baseline says; with ``exact`` every tolerance is zero."""
    differences = []
    for name in dict.fromkeys((*run.numbers, *found.numbers)):
        expected, allowed = run.numbers.get(name, (None, 0.0))
        value = found.numbers.get(name)
        apart = distance(name, expected, value)
        differences.append(Difference(name, expected, value, apart, 0.0 if exact else allowed))
    for name in dict.fromkeys((*run.texts, *found.texts)):
        before, now = run.texts.get(name), found.texts.get(name)
        differences.append(Difference(name, before, now, 0.0 if before == now else math.inf, 0.0))
    return tuple(differences)


def worst_first(comparisons: Iterable[Comparison]) -> list[tuple[Comparison, Difference]]:
    """Every miss of every run, the worst angle first."""
    misses = [(comparison, miss) for comparison in comparisons for miss in comparison.misses]
    return sorted(misses, key=lambda pair: pair[1].rank)
