"""A parameter study: ``--vary key=a,b,c``, every combination of the values of every key."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from scenarios.errors import InputError

OPENING, CLOSING, QUOTES = "[{", "]}", "\"'"


@dataclass(frozen=True)
class Variation:
    """A key of the scenario file and the values that it takes in turn, each as it is written."""

    key: str
    values: tuple[str, ...]


def parse_variations(texts: Sequence[str], changes: Sequence[str] = ()) -> tuple[Variation, ...]:
    """The variations in ``key=a,b,c`` texts. Values are as with ``--set``.

    Args:
        texts: one variation each.
        changes: ``key=value`` texts of the same study, which may not set what is varied.

    Raises:
        InputError: that is no variation, a key or a value comes twice, or a key is changed and varied.

    >>> parse_variations(["robot.tyre_friction=0.2,0.8", "agents.3.start=[0, 1],[0, 2]"])[1]
    Variation(key='agents.3.start', values=('[0, 1]', '[0, 2]'))
    """
    changed = {change.partition("=")[0].strip() for change in changes}
    variations: dict[str, Variation] = {}
    for text in texts:
        key, _, listed = (part.strip() for part in text.partition("="))
        values = tuple(value.strip() for value in _split(listed))
        if not key or not all(values):
            raise InputError(f"--vary {text[:80]}: expected KEY=V1,V2,... with values as in --set")
        if len(set(values)) < len(values):
            twice = next(value for value in values if values.count(value) > 1)
            raise InputError(f"--vary {key}: the value {twice[:80]} is listed twice")
        if key in variations or key in changed:
            raise InputError(f"--vary {key[:80]}: is {'varied twice' if key in variations else 'set to one value too'}")
        variations[key] = Variation(key, values)
    return tuple(variations.values())


def combinations(variations: Sequence[Variation]) -> list[tuple[str, ...]]:
    """Every combination of the values, a value per variation, the last one changing fastest.

    >>> combinations([Variation("a", ("1", "2")), Variation("b", ("x", "y"))])
    [('1', 'x'), ('1', 'y'), ('2', 'x'), ('2', 'y')]
    >>> combinations([])
    [()]
    """
    return list(itertools.product(*(variation.values for variation in variations)))


def _split(text: str) -> list[str]:
    """The parts between commas that stand in no brackets and no quotes."""
    parts, depth, quote = [""], 0, ""
    for character in text:
        if quote:
            quote = "" if character == quote else quote
        elif character in QUOTES:
            quote = character
        elif character in OPENING:
            depth += 1
        elif character in CLOSING:
            depth -= 1
        elif character == "," and depth == 0:
            parts.append("")
            continue
        parts[-1] += character
    return parts
