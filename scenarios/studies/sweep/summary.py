"""What the rows of a sweep say together, told as they come."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass

from scenarios.studies.sweep.quantiles import Column
from scenarios.studies.sweep.row import FAILED, Row

QUANTILES = (0.0, 0.05, 0.5, 0.95, 1.0)

QUANTITIES = ("settling_time_s", "angle_error_sum_rad", "min_separation_m", "min_clearance_m", "min_hull_clearance_m")
"""Columns whose quantiles are told."""

MOST_LISTED = 1000
"""Seeds that a list names; memory does not grow with the number of runs."""

DOUBT = 0.05
"""Chance that an interval misses the true share, half of it on either side."""


@dataclass(frozen=True)
class Share:
    """A share of the runs with its exact 95 % interval (Clopper-Pearson).

    Whatever the true share is, the interval holds it in at least 95 of 100 such sweeps.
    """

    share: float
    low: float
    high: float

    @classmethod
    def of(cls, count: int, total: int) -> Share:
        """The share of ``count`` among ``total`` > 0 runs.

        >>> round(Share.of(0, 1_000_000).high * 1e6, 2)
        3.69
        """
        from scipy.special import betaincinv

        low = betaincinv(count, total - count + 1, DOUBT / 2.0) if count else 0.0
        high = betaincinv(count + 1, total - count, 1.0 - DOUBT / 2.0) if count < total else 1.0
        return cls(count / total, float(low), float(high))


@dataclass(frozen=True)
class Misses:
    """The runs that missed their goal for one cause.

    Attributes:
        cause: a key of :data:`scenarios.studies.sweep.cause.MEANINGS`.
        count: their number.
        share: of all runs.
        seeds: the first :data:`MOST_LISTED` of them.
    """

    cause: str
    count: int
    share: Share
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Summary:
    """What the rows say together.

    Attributes:
        runs: their number.
        converged, accepted: shares of the runs.
        missed: the first :data:`MOST_LISTED` seeds of runs that did not reach their goal.
        failed: the same of runs that could not be made.
        failure: what the first of them said; None without one.
        causes: why runs missed their goal or could not be made, the most frequent one first.
        quantiles: at :data:`QUANTILES`, by column; of the runs that have one; None where none has.
    """

    runs: int
    converged: Share
    accepted: Share
    missed: tuple[int, ...]
    failed: tuple[int, ...]
    failure: str | None
    causes: tuple[Misses, ...]
    quantiles: dict[str, tuple[float, ...] | None]


class Tally:
    """Rows of one combination, counted as they come."""

    def __init__(self) -> None:
        self._columns = {column: Column() for column in QUANTITIES}
        self._runs = self._converged = self._accepted = 0
        self._missed: list[int] = []
        self._failed: list[int] = []
        self._failure: str | None = None
        self._causes: dict[str, tuple[int, list[int]]] = {}

    def close(self) -> None:
        """Forget the rows."""
        for column in self._columns.values():
            column.close()

    @property
    def runs(self) -> int:
        """Rows so far."""
        return self._runs

    def add(self, row: Row) -> None:
        """Count the next row."""
        self._runs += 1
        self._accepted += row.accepted is True
        for name, column in self._columns.items():
            value = getattr(row, name)
            if value is not None:
                column.add(value)
        if row.outcome == "converged":
            self._converged += 1
            return
        if row.outcome == FAILED and self._failure is None:
            self._failure = row.message
        count, seeds = self._causes.get(row.cause, (0, []))
        self._causes[row.cause] = count + 1, seeds
        for listed in (seeds, self._failed if row.outcome == FAILED else self._missed):
            if len(listed) < MOST_LISTED:
                listed.append(row.seed)

    def summary(self) -> Summary:
        """What the rows so far, one at least, say together."""
        causes = sorted(self._causes.items(), key=lambda item: (-item[1][0], item[0]))
        return Summary(
            runs=self._runs,
            converged=Share.of(self._converged, self._runs),
            accepted=Share.of(self._accepted, self._runs),
            missed=tuple(self._missed),
            failed=tuple(self._failed),
            failure=self._failure,
            causes=tuple(
                Misses(cause, count, Share.of(count, self._runs), tuple(seeds)) for cause, (count, seeds) in causes
            ),
            quantiles={name: column.quantiles(QUANTILES) for name, column in self._columns.items()},
        )


class Tallies:
    """Rows of all combinations in their order, ``each`` of one, counted as they come."""

    def __init__(self, each: int) -> None:
        self._each = each
        self._finished: list[Summary] = []
        self._current = Tally()

    def close(self) -> None:
        """Forget the rows."""
        self._current.close()

    def add(self, rows: Iterable[Row]) -> None:
        """Count the next rows."""
        for row in rows:
            self._current.add(row)
            if self._current.runs == self._each:
                self._finished.append(self._current.summary())
                self._current.close()
                self._current = Tally()

    def summaries(self) -> list[Summary]:
        """Of each combination that has rows so far."""
        return [*self._finished, *([self._current.summary()] if self._current.runs else [])]


def summarise(rows: Iterable[Row]) -> Summary:
    """The summary of rows, one at least."""
    with closing(Tally()) as tally:
        for row in rows:
            tally.add(row)
        return tally.summary()
