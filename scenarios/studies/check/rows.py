"""The rows of the printed and the written comparison: one per case, and one per miss."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import groupby

from scenarios.studies.check.compare import Comparison, Difference

CASES = ("scenario", "plant", "changes", "runs", "angles (rad)", "settling (s)", "separation (m)", "result")
"""Columns of the table of cases: the largest differences from the baseline, and how many runs missed."""

MISSES = ("scenario", "plant", "changes", "seed", "quantity", "baseline", "now", "difference", "tolerance")

LISTED = 20
"""Misses that a table lists."""


def case_rows(comparisons: Iterable[Comparison]) -> list[tuple[str, ...]]:
    """One row per scenario, plant and changes."""
    rows = []
    for (scenario, plant, changes), group in groupby(
        comparisons, key=lambda c: (c.scenario, c.run.plant, " ".join(c.run.changes))
    ):
        runs = list(group)
        missed = sum(bool(run.misses) for run in runs)
        worst = (
            number(max((w for run in runs if (w := run.worst(suffix)) is not None), default=None))
            for suffix in (".final_rad", "settling_time_s", ".distance_m")
        )
        rows.append((scenario, plant, changes, str(len(runs)), *worst, f"{missed} missed" if missed else "as before"))
    return rows


def miss_row(comparison: Comparison, miss: Difference) -> tuple[str, ...]:
    """One miss."""
    run = comparison.run
    return (
        comparison.scenario,
        run.plant,
        " ".join(run.changes),
        str(run.seed),
        miss.name,
        value(miss.expected),
        value(miss.found),
        number(miss.difference) if math.isfinite(miss.difference) else "-",
        number(miss.tolerance),
    )


def number(amount: float | None) -> str:
    """A difference or a tolerance."""
    return "-" if amount is None else f"{amount:.1e}" if amount else "0"


def value(content: float | str | None) -> str:
    """What a baseline or a run says of one quantity."""
    return "never" if content is None else content if isinstance(content, str) else f"{content:.9g}"
