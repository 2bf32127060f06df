"""What the rows of a sweep say together, read column by column."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice

import numpy as np

from scenarios.studies.sweep.row import FAILED

QUANTILES = (0.0, 0.05, 0.5, 0.95, 1.0)

QUANTITIES = ("settling_time_s", "angle_error_sum_rad", "min_separation_m", "min_clearance_m", "min_hull_clearance_m")
"""Columns whose quantiles are told."""

Z_95 = 1.959963984540054
"""Standard normal quantile of a two-sided 95 % interval."""


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
        missed: seeds of the runs that did not reach their goal.
        failed: seeds of the runs that could not be made.
        failure: what the first of them said; None without one.
        quantiles: at :data:`QUANTILES`, by column; of the runs that have one; None where none has.
    """

    runs: int
    converged: Share
    accepted: Share
    missed: tuple[int, ...]
    failed: tuple[int, ...]
    failure: str | None
    quantiles: dict[str, tuple[float, ...] | None]


def summarise(rows: Iterator[Mapping[str, str]], count: int) -> Summary:
    """The summary of the next ``count`` > 0 rows, cells by column as ``rows.csv`` has them.

    Eight bytes a row and quantity are kept of them.
    """
    converged = accepted = 0
    missed, failed, failure = array("q"), array("q"), None
    values = {column: array("d") for column in QUANTITIES}
    for row in islice(rows, count):
        converged += row["outcome"] == "converged"
        accepted += row["accepted"] == "True"
        if row["outcome"] == FAILED:
            failed.append(int(row["seed"]))
            failure = row["message"] if failure is None else failure
        elif row["outcome"] != "converged":
            missed.append(int(row["seed"]))
        for column, found in values.items():
            if cell := row.get(column):
                found.append(float(cell))
    return Summary(
        runs=count,
        converged=Share.of(converged, count),
        accepted=Share.of(accepted, count),
        missed=tuple(missed),
        failed=tuple(failed),
        failure=failure,
        quantiles={
            column: tuple(np.quantile(np.asarray(found), QUANTILES).tolist()) if found else None
            for column, found in values.items()
        },
    )
