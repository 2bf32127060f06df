"""How a script writes numbers, strings, lists of tuples and prose: 79 columns, and no digit lost."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

WIDTH = 79
"""Columns of a line, PEP 8."""


def number(value: complex) -> str:
    """A complex number as Python writes it, without its zero part; every digit is kept.

    >>> number(0.5 - 0.25j), number(0.35 + 0j), number(-0.01j)
    ('0.5 - 0.25j', '0.35', '-0.01j')
    """
    if value.imag == 0.0:
        return repr(value.real)
    if value.real == 0.0:
        return f"{value.imag!r}j"
    return f"{value.real!r} {'-' if value.imag < 0.0 else '+'} {abs(value.imag)!r}j"


def quoted(text: str) -> str:
    """A string literal, in double quotes where that needs no escapes.

    >>> print(quoted("turn"), quoted('the "turn"'))
    "turn" 'the "turn"'
    """
    literal = repr(text)
    return f'"{literal[1:-1]}"' if literal[0] == "'" and '"' not in text else literal


def table(rows: Iterable[Iterable[str]], indent: int = 4) -> str:
    """The lines of a list of tuples; a tuple that is too long for one line takes a line for each item."""
    lines = []
    for row in rows:
        items, margin = list(row), " " * indent
        line = f"{margin}({', '.join(items)}),"
        if len(line) > WIDTH:
            line = "\n".join([f"{margin}(", *(f"{margin}    {item}," for item in items), f"{margin}),"])
        lines.append(line)
    return "\n".join(lines)


def prose(text: str) -> str:
    """Text for a docstring: wrapped, and nothing in it that could end the docstring or the line."""
    plain = "".join(character if character.isprintable() else " " for character in text)
    return textwrap.fill(
        plain.replace("\\", "\\\\").replace('"""', '\\"\\"\\"'), WIDTH, break_long_words=False, break_on_hyphens=False
    )
