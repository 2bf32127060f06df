"""The comparison on the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape

from scenarios.errors import plain
from scenarios.studies.check.compare import worst_first
from scenarios.studies.check.repeat import Check
from scenarios.studies.check.reports import Folders
from scenarios.studies.check.rows import CASES, LISTED, MISSES, case_rows, miss_row
from scenarios.studies.check.update import Update
from scenarios.terminal import new_table, print_table


def print_check(console: Console, check: Check) -> None:
    """Every case, then what was missed, the worst angle first."""
    table = new_table(*CASES)
    for row in case_rows(check.comparisons):
        table.add_row(*map(escape, row[:-1]), row[-1], style="red" if row[-1].endswith("missed") else None)
    print_table(console, table)
    misses = worst_first(check.comparisons)
    if misses:
        table = new_table(*MISSES, title="\nMissed, the worst angle first")
        for pair in misses[:LISTED]:
            table.add_row(*map(escape, miss_row(*pair)))
        print_table(console, table)
        if len(misses) > LISTED:
            console.print(f"and {len(misses) - LISTED} more")
    console.print()
    for note in check.notes:
        console.print(escape(note))
    console.print(f"[bold]{check.summary}[/bold]")


def print_folders(console: Console, check: Check, folders: Folders) -> None:
    """How to look at the runs that missed."""
    for comparison in check.missed:
        if comparison in folders:
            console.print(plain(f"formation replay {folders[comparison]}"), markup=False, soft_wrap=True)
    others = len(check.missed) - len(folders)
    if others:
        console.print(f"and {others} more; `formation run` makes them again")


def print_update(console: Console, update: Update) -> None:
    """What a new baseline says that the old one did not."""
    baseline = update.baseline
    same = sum(not comparison.misses for comparison in update.changed)
    console.print(
        f"[bold]{escape(update.scenario)}[/bold]: {len(baseline.runs)} runs, {update.added} new, {same} unchanged, "
        f"{len(update.changed) - same} changed, {update.removed} removed"
    )
    for left_out in baseline.left_out:
        changes = "".join(f" {change}" for change in left_out.changes)
        console.print(f"  left out: {left_out.plant} seed {left_out.seed}{changes}: {left_out.reason}", markup=False)
    misses = worst_first(update.changed)
    if misses:
        table = new_table(*MISSES)
        for pair in misses[:LISTED]:
            table.add_row(*map(escape, miss_row(*pair)))
        print_table(console, table)
        if len(misses) > LISTED:
            console.print(f"and {len(misses) - LISTED} more")
