"""The one exception for bad input, and the nearest right name for a misspelt one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager


class InputError(ValueError):
    """Input that cannot be used. Its message is one line: file, field, value and what was expected."""


MOST_LISTED = 24
"""Known names that a message lists."""


def did_you_mean(name: str, known: Iterable[str], where: str | None = None) -> str:
    """A clause that offers the nearest known name, or lists the known ones, or says where so many are listed.

    >>> did_you_mean("shpae", ["maneuver", "shape"])
    "did you mean 'shape'?"
    >>> did_you_mean("q", ["maneuver", "shape"])
    'known: maneuver, shape'
    """
    options = list(known)
    close = difflib.get_close_matches(name, options, n=1, cutoff=0.6)
    rest = f" and {len(options) - MOST_LISTED} more" if len(options) > MOST_LISTED else ""
    return f"did you mean {close[0]!r}?" if close else where or f"known: {', '.join(options[:MOST_LISTED])}{rest}"


def plain(text: str) -> str:
    """Text as a terminal may show it: what controls one, or cannot be printed, is spelt out.

    >>> print(plain("a\\x1b[31m\\x9b2Jb"))
    a\\x1b[31m\\x9b2Jb
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


@contextmanager
def located(file: str, field: str) -> Iterator[None]:
    """Give a ValueError of the theory or of the machines the file and the field that it came from."""
    try:
        yield
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{file}: {field}: {error}") from error
