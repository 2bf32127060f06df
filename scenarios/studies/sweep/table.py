"""The summary of a sweep on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

from rich.console import Console
from rich.markup import escape

from scenarios.errors import plain
from scenarios.studies.sweep.cause import ERROR, MEANINGS
from scenarios.studies.sweep.folder import ROWS
from scenarios.studies.sweep.study import Study
from scenarios.studies.sweep.summary import QUANTILES, Share, Summary
from scenarios.studies.sweep.sweep import Swept
from scenarios.terminal import new_table, print_table

QUANTITIES = {
    "settling_time_s": ("settling time (s)", ".1f"),
    "angle_error_sum_rad": ("angle error sum (rad)", ".1e"),
    "min_separation_m": ("min separation (m)", ".3f"),
    "min_clearance_m": ("min clearance of a point (m)", ".3f"),
    "min_hull_clearance_m": ("min clearance of a hull (m)", ".3f"),
}

IN_A_LINE = {
    "settling_time_s": ("median settling (s)", 0.5, ".1f"),
    "angle_error_sum_rad": ("median error (rad)", 0.5, ".1e"),
    "min_separation_m": ("least separation (m)", 0.0, ".3f"),
}
"""What a combination's line shows: title, quantile and format."""


MISSED_SHOWN = 10
"""Seeds of runs that did not converge that a line has room for."""


def print_sweep(console: Console, study: Study, swept: Swept) -> None:
    """What the rows say together, and where they are."""
    if swept.kept:
        told = "all" if swept.kept == study.runs else f"{swept.kept} of {study.runs}"
        console.print(f"continued: {told} rows were there; --restart makes them anew")
    if study.variations:
        _print_combinations(console, study, swept.summaries)
    else:
        _print_summary(console, swept.summaries[0])
    _print_missed(console, study, swept.summaries)
    console.print(f"rows: {escape(plain(str(swept.folder / ROWS)))}")


def _print_missed(console: Console, study: Study, summaries: Sequence[Summary]) -> None:
    """Which runs missed their goal or could not be made, how often for what cause, and what shows the first of each."""
    examples: dict[str, str] = {}
    for combination, summary in zip(study.combinations, summaries, strict=True):
        where = f" with {', '.join(combination.changes)}" if combination.changes else ""
        of_errors = sum(misses.count for misses in summary.causes if misses.cause == ERROR)
        of_runs = sum(misses.count for misses in summary.causes) - of_errors
        for what, seeds, count in (("failed", summary.failed, of_errors), ("not converged", summary.missed, of_runs)):
            if seeds:
                shown = seeds[:MISSED_SHOWN]
                more = f" and {count - len(shown)} more" if count > len(shown) else ""
                said = f": {summary.failure}" if what == "failed" else ""
                named = f"{'seed' if count == 1 else 'seeds'} {', '.join(map(str, shown))}{more}"
                console.print(escape(f"{what}{where}: {named}{said}"))
        for misses in summary.causes:
            console.print(escape(f"  {misses.count} {MEANINGS[misses.cause]}: {_share(misses.share)}"))
            examples.setdefault(misses.cause, study.command(combination, misses.seeds[0]))
    for cause, example in examples.items():
        which = f"  # {MEANINGS[cause]}" if len(examples) > 1 else ""
        console.print(escape(f"to see the first: {example}{which}"), soft_wrap=True)


def _print_combinations(console: Console, study: Study, summaries: Sequence[Summary]) -> None:
    """A line per combination."""
    console.print(
        f"[bold]{study.runs} runs[/bold], {study.seeds.count} of each combination; shares with 95 % intervals"
    )
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
        if values is None and "clearance" in column:  # neither walls nor obstacles
            continue
        table.add_row(title, *(["-"] * len(QUANTILES) if values is None else (format(v, form) for v in values)))
    console.print()
    print_table(console, table)


def _share(share: Share) -> str:
    """A share with its interval, to the digits that tell its smaller side from 0."""
    rare = min(share.share, 1.0 - share.share)
    digits = 1 if rare == 0.0 or rare >= 0.01 else 1 - floor(log10(100.0 * rare))
    low, high = (f"{end:.{digits}%}" for end in (share.low, share.high))
    return f"{share.share:.{digits}%} (95 % interval {low} to {high})"
