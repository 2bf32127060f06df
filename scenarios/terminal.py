"""What every printed report is made of: the console, tables without borders, and a progress bar."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn
from rich.table import Table

LEFT = frozenset(
    ("scenario", "title", "angle", "agent", "senses", "phase", "plant", "law", "measures", "frame", "fixes")
    + ("key", "kind", "default", "meaning", "changes", "quantity", "result", "replay")
    + ("check", "verdict", "remark", "script", "differs")
)
"""Columns of text; all others hold numbers and are aligned right."""

PROGRESS_INTERVAL = 0.1
"""Seconds between two updates of a progress bar: more often cannot be read, and costs time."""

WIDEST = 1000
"""Characters of a line, at most."""


def new_console() -> Console:
    """The terminal; where there is none, wide enough for every table."""
    return Console(highlight=False, soft_wrap=True, width=shutil.get_terminal_size((160, 25)).columns)


@contextmanager
def progress_bar(console: Console, name: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on a terminal, gone when the work is done; the block calls what it gets with (done, total)."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:.0f} %"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(escape(name))
        due = time.monotonic()

        def advance(done: int, total: int) -> None:
            nonlocal due
            if (now := time.monotonic()) >= due or done == total:
                due = now + PROGRESS_INTERVAL
                progress.update(task, completed=done, total=total)

        yield advance


@contextmanager
def open_ended(console: Console, name: str) -> Iterator[Callable[[str], None]]:
    """A progress line for work whose end is not known; the block calls what it gets with what there is to say."""
    columns = SpinnerColumn(), TextColumn("{task.description}"), TextColumn("{task.fields[said]}")
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(escape(name), said="")
        due = monotonic()

        def say(text: str) -> None:
            nonlocal due
            if (now := monotonic()) >= due:
                due = now + PROGRESS_INTERVAL
                progress.update(task, said=text)

        yield say


def new_table(*columns: str, title: str | None = None) -> Table:
    """An empty table with these columns."""
    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in columns:
        left = column in LEFT
        table.add_column(column, justify="left" if left else "right", no_wrap=column not in ("title", "meaning"))
    return table


def print_table(console: Console, table: Table) -> None:
    """Print a table with all its digits: where it is wider than the terminal, the terminal wraps its lines."""
    terminal = console.width
    needed = Measurement.get(console, console.options.update(max_width=WIDEST), table).maximum
    console.width = max(terminal, needed)
    try:
        console.print(table)
    finally:
        console.width = terminal
