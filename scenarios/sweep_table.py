"""The summary of a sweep on the terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.markup import escape

from scenarios.sweep import QUANTILES, ROWS, Share, Summary
from scenarios.terminal import new_table, print_table

QUANTITIES = {
    "settling_time_s": ("settling time (s)", ".1f"),
    "angle_error_sum_rad": ("angle error sum (rad)", ".1e"),
    "min_separation_m": ("min separation (m)", ".3f"),
}


def print_sweep(console: Console, summary: Summary, folder: Path) -> None:
    """Shares with their intervals, quantiles, and where the rows are."""
    console.print(f"[bold]{summary.runs} runs[/bold]")
    for name, share in (("converged", summary.converged), ("accepted by the testbed", summary.accepted)):
        console.print(f"{name}: {_share(share)}")
    table = new_table("quantity", "least", *(f"{level:.0%}" for level in QUANTILES[1:-1]), "most")
    for column, (title, form) in QUANTITIES.items():
        values = summary.quantiles[column]
        table.add_row(title, *(["-"] * len(QUANTILES) if values is None else (format(v, form) for v in values)))
    console.print()
    print_table(console, table)
    console.print(f"rows: {escape(str(folder / ROWS))}")


def _share(share: Share) -> str:
    return f"{share.share:.1%} (95 % interval {share.low:.1%} to {share.high:.1%})"
