"""The seeds of a sweep: ``A:B``, ``N``, or a list of both."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, pairwise

from scenarios.errors import InputError

PART = re.compile(r"\s*(\d{1,18})\s*(?::\s*(\d{1,18})\s*)?")

LONGEST_NAME = 40
"""Characters of a folder's name that seeds may take."""


@dataclass(frozen=True)
class Seeds:
    """Seeds in the order in which they run, held as ranges: a million million of them cost what one costs.

    Attributes:
        parts: ranges that are not empty and share no seed.
    """

    parts: tuple[range, ...]

    @property
    def count(self) -> int:
        """Their number."""
        return sum(part.stop - part.start for part in self.parts)  # len() ends at 2^63

    @property
    def first(self) -> int:
        """The seed that runs first."""
        return self.parts[0].start

    def __iter__(self) -> Iterator[int]:
        return chain.from_iterable(self.parts)

    def after(self, done: int) -> Iterator[int]:
        """Those that are left when the first ``done`` have run."""
        for part in self.parts:
            size = part.stop - part.start
            yield from part[min(done, size) :]
            done = max(0, done - size)

    def __str__(self) -> str:
        return ",".join(f"{p.start}" if p.stop == p.start + 1 else f"{p.start}:{p.stop}" for p in self.parts)

    @property
    def in_a_name(self) -> str:
        """As part of a folder's name, first and last seed of each range."""
        shown = [f"{p.start}" if p.stop == p.start + 1 else f"{p.start}-{p.stop - 1}" for p in self.parts]
        return name if len(name := "+".join(shown)) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}..."


def parse_seeds(text: str) -> Seeds:
    """The seeds A to B - 1 of ``A:B``, the one of ``N``, or those of a list of both, in the order of the list.

    Raises:
        InputError: that is none of these, or a seed comes twice.

    >>> list(parse_seeds("1,5,7:9"))
    [1, 5, 7, 8]
    """
    parts = []
    for entry in text.split(","):
        match = PART.fullmatch(entry)
        start, stop = (int(match[1]), int(match[2] or int(match[1]) + 1)) if match else (0, 0)
        if not start < stop:
            raise InputError(
                f"--seeds {text[:40]}: expected A:B with 0 <= A < B for the seeds A to B - 1, one seed N, or a list "
                "of such, as in 1,5,7:9"
            )
        parts.append(range(start, stop))
    for before, after in pairwise(sorted(parts, key=lambda part: part.start)):
        if after.start < before.stop:
            raise InputError(f"--seeds {text[:40]}: the seed {after.start} is listed twice")
    return Seeds(tuple(parts))
