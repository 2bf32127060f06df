"""What every printed report is made of: the console, tables without borders, and a progress bar."""

from __future__ import annotations

import os
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from time import monotonic
from typing import Any

from rich.console import Console, ConsoleDimensions
from rich.markup import escape
from rich.measure import Measurement
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from scenarios.errors import plain

LEFT = frozenset(
    ("scenario", "title", "angle", "agent", "senses", "phase", "plant", "law", "measures", "frame", "fixes")
    + ("key", "kind", "default", "meaning", "changes", "quantity", "result", "replay")
    + ("check", "verdict", "remark", "graph", "script", "differs", "rung")
)
"""Columns of text; all others hold numbers and are aligned right."""

WRAPPED = frozenset(("title", "kind", "meaning", "remark"))
"""Columns of words, which may take several lines."""

PROGRESS_INTERVAL = 0.1
"""Seconds between two updates of a progress bar: more often cannot be read, and costs time."""

SAID_EVERY = 10.0
"""Seconds between two lines about the progress of work that no terminal watches."""

GAP = 2
"""Blanks between two columns."""

WIDEST = 1000
"""Characters of a line, at most."""

DEEP = 2 * GAP
"""Blanks before a line, at most, that goes on further in than it began; more are of what a label stands before."""

LABEL = re.compile(r"\S+ {2,}(?=\S)")
"""A word that a line of a description begins with, set off by blanks: ``Goal        all angles below ...``."""


class Terminal(Console):
    """A console whose lines break between words where somebody reads them; programs get them whole.

    What is to be copied as a whole, a command say, is printed with ``soft_wrap=True``, and the terminal breaks it.
    """

    def print(self, *objects: Any, soft_wrap: bool | None = None, **options: Any) -> None:
        """Print; a text that is too long goes on under its first word, or under what its label is followed by."""
        if soft_wrap is None and len(objects) == 1 and isinstance(objects[0], str) and self._is_read:
            literal = options.get("markup") is False
            objects = (_broken(Text(objects[0]) if literal else Text.from_markup(objects[0]), self.width),)
        super().print(*objects, soft_wrap=soft_wrap, **options)

    @property
    def _is_read(self) -> bool:
        return self.is_terminal or "COLUMNS" in os.environ  # who says how wide it is will read it


def new_console(stderr: bool = False) -> Terminal:
    """The terminal; where there is none, wide enough for every table. ``stderr`` leaves the output to programs."""
    return Terminal(highlight=False, soft_wrap=True, width=shutil.get_terminal_size((160, 25)).columns, stderr=stderr)


@contextmanager
def progress_bar(console: Console, name: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on a terminal, gone when the work is done; the block calls what it gets with (done, total).

    Where the output goes elsewhere, a line on stderr now and then.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:.0f} %"),
        TimeRemainingColumn(),
    )
    begun, watched = monotonic(), _is_watched(console)
    with Progress(*columns, console=console, transient=True, disable=not watched) as progress:
        task = progress.add_task(escape(name))
        due = begun if watched else begun + SAID_EVERY

        def advance(done: int, total: int) -> None:
            nonlocal due
            now = monotonic()
            if watched and (now >= due or done == total):
                due = now + PROGRESS_INTERVAL
                progress.update(task, completed=done, total=total)
            elif not watched and now >= due and 0 < done < total:
                due = now + SAID_EVERY
                left = (now - begun) * (total - done) / done
                _say(console, f"{name}: {done} of {total}, {100.0 * done / total:.0f} %, about {left:.0f} s left")

        yield advance


@contextmanager
def open_ended(console: Console, name: str) -> Iterator[Callable[[str], None]]:
    """A progress line for work whose end is not known; the block calls what it gets with what there is to say."""
    columns = SpinnerColumn(), TextColumn("{task.description}"), TextColumn("{task.fields[said]}")
    watched = _is_watched(console)
    with Progress(*columns, console=console, transient=True, disable=not watched) as progress:
        task = progress.add_task(escape(name), said="")
        due = monotonic() + (0.0 if watched else SAID_EVERY)

        def say(text: str) -> None:
            nonlocal due
            if (now := monotonic()) >= due:
                due = now + (PROGRESS_INTERVAL if watched else SAID_EVERY)
                if watched:
                    progress.update(task, said=text)
                else:
                    _say(console, f"{name}: {text}")

        yield say


def _broken(text: Text, width: int) -> Text:
    """The text in lines of at most so many characters, but for longer words, with its styles."""
    lines = []
    for line in text.split("\n", allow_blank=True):
        label, blanks = LABEL.match(line.plain), len(line.plain) - len(line.plain.lstrip())
        inner = " " * (len(label[0]) if label else blanks if blanks > DEEP else blanks + GAP)
        end = 0
        for part in textwrap.wrap(
            line.plain,
            width,
            subsequent_indent=inner,
            expand_tabs=False,
            break_long_words=False,
            break_on_hyphens=False,
        ) or [""]:
            words = part.removeprefix(inner) if end else part
            begin = line.plain.index(words, end)
            lines.append(Text(inner if end else "") + line[begin : begin + len(words)])
            end = begin + len(words)
    return Text("\n").join(lines)


def _is_watched(console: Console) -> bool:
    """Whether somebody sees a line that changes; colours that are forced into a file make no terminal of it."""
    return console.is_terminal and console.file.isatty()


def _say(console: Console, text: str) -> None:
    if not console.quiet:
        print(plain(text), file=sys.stderr, flush=True)


def new_table(*columns: str, title: str | None = None) -> Table:
    """An empty table with these columns."""
    table = Table(
        title=title, title_justify="left", title_style="bold", box=None, pad_edge=False, padding=(0, GAP, 0, 0)
    )
    for column in columns:
        left = column in LEFT
        table.add_column(column, justify="left" if left else "right", no_wrap=column not in WRAPPED)
    return table


def print_table(console: Console, table: Table) -> None:
    """Print a table with all its digits.

    Where it is wider than the terminal, columns that do not fit beside the others follow below, beside the first column
    again; a single column that is wider still, the terminal wraps.
    """
    parts = _parts(console, table)
    for part in parts:
        if part is not parts[0]:
            console.print()
        size = console.size
        console.size = ConsoleDimensions(max(size.width, _least_width(console, part)), size.height)
        try:
            console.print(part)
        finally:
            console.size = size


def _parts(console: Console, table: Table) -> list[Table]:
    """The table, or several with some of its columns each that fit the console; the first column leads them all."""
    lead, *others = range(len(table.columns))
    chosen = [[lead]]
    for column in others:
        if len(chosen[-1]) > 1 and _least_width(console, _with(table, [*chosen[-1], column])) > console.width:
            chosen.append([lead])
        chosen[-1].append(column)
    return [table] if len(chosen) == 1 else [_with(table, columns) for columns in chosen]


def _with(table: Table, columns: list[int]) -> Table:
    """The table with these columns alone, in their order; its title above those that have its second column."""
    part = copy(table)
    part.columns = [replace(table.columns[old], _index=new) for new, old in enumerate(columns)]
    part.title = table.title if columns[1:2] == [1] else None
    return part


def _least_width(console: Console, table: Table) -> int:
    """Characters that the table needs so that nothing is cut off, with text wrapped where it may be."""
    wide = console.options.update(max_width=WIDEST)
    widths = []
    for index, column in enumerate(table.columns):
        needed = Measurement.get(console, wide, _with(table, [index]))
        widths.append(needed.maximum if column.no_wrap else needed.minimum)
    return sum(widths) + GAP * (len(widths) - 1)
