"""The summary of a sweep on the terminal."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from scenarios.studies.sweep import QUANTILES, ROWS, Share, Study, Summary
from scenarios.terminal import new_table, print_table

QUANTITIES = {
    "settling_time_s": ("settling time (s)", ".1f"),
    "angle_error_sum_rad": ("angle error sum (rad)", ".1e"),
    "min_separation_m": ("min separation (m)", ".3f"),
}

IN_A_LINE = {
    "settling_time_s": ("median settling (s)", 0.5, ".1f"),
    "angle_error_sum_rad": ("median error (rad)", 0.5, ".1e"),
    "min_separation_m": ("least separation (m)", 0.0, ".3f"),
}
"""What a combination's line shows: title, quantile and format."""


MISSED_SHOWN = 10
"""Seeds of runs that did not converge that a line has room for."""


def print_sweep(console: Console, study: Study, summaries: Sequence[Summary], folder: Path) -> None:
    """What the rows say together, and where they are."""
    if study.variations:
        _print_combinations(console, study, summaries)
    else:
        _print_summary(console, summaries[0])
    _print_missed(console, study, summaries)
    console.print(f"rows: {escape(str(folder / ROWS))}")


def _print_missed(console: Console, study: Study, summaries: Sequence[Summary]) -> None:
    """Which runs did not converge, and the command that shows the first of them."""
    example = None
    for combination, summary in zip(study.combinations, summaries, strict=True):
        if not summary.missed:
            continue
        where = f" with {', '.join(combination.changes)}" if combination.changes else ""
        seeds = ", ".join(map(str, summary.missed[:MISSED_SHOWN]))
        more = len(summary.missed) - MISSED_SHOWN
        console.print(f"not converged{escape(where)}: seeds {seeds}{f' and {more} more' if more > 0 else ''}")
        if example is None:
            changes = [text for change in (*study.changes, *combination.changes) for text in ("--set", change)]
            seed = str(summary.missed[0])
            example = shlex.join(["formation", "run", combination.file.path, "--seed", seed, *changes])
    if example is not None:
        console.print(f"to see the first: {escape(example)}")


def _print_combinations(console: Console, study: Study, summaries: Sequence[Summary]) -> None:
    """A line per combination."""
    console.print(f"[bold]{study.runs} runs[/bold], {len(study.seeds)} of each combination; shares with 95 % intervals")
    console.print()
    measured = [title for title, _, _ in IN_A_LINE.values()]
    keys = [escape(variation.key) for variation in study.variations]
    table = new_table(*keys, "converged", "accepted", *measured)
    for combination, summary in zip(study.combinations, summaries, strict=True):
        cells = []
        for column, (_, level, form) in IN_A_LINE.items():
            values = summary.quantiles[column]
            cells.append("-" if values is None else format(values[QUANTILES.index(level)], form))
        shares = [f"{s.share:.1%} ({s.low:.0%} to {s.high:.0%})" for s in (summary.converged, summary.accepted)]
        table.add_row(*map(escape, combination.values), *shares, *cells)
    print_table(console, table)


def _print_summary(console: Console, summary: Summary) -> None:
    console.print(f"[bold]{summary.runs} runs[/bold]")
    for name, share in (("converged", summary.converged), ("accepted by the testbed", summary.accepted)):
        console.print(f"{name}: {_share(share)}")
    table = new_table("quantity", "least", *(f"{level:.0%}" for level in QUANTILES[1:-1]), "most")
    for column, (title, form) in QUANTITIES.items():
        values = summary.quantiles[column]
        table.add_row(title, *(["-"] * len(QUANTILES) if values is None else (format(v, form) for v in values)))
    console.print()
    print_table(console, table)


def _share(share: Share) -> str:
    return f"{share.share:.1%} (95 % interval {share.low:.1%} to {share.high:.1%})"
