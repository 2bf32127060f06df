"""Shares with their intervals, beside those of a first computation by other code, with other starts.

The first computation used 300 starts (the triangle's 1,000) and the same square, target and tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot, sqrt
from typing import NamedTuple

NORMAL = 1.959963984540054
"""Standard deviations of a 95 % interval."""

STRICT = 3.290526731491926
"""Of a 99.9 % interval."""


class First(NamedTuple):
    """What the first computation gave for a row: how many of its runs were right, and why another number is here."""

    right: int
    runs: int
    why: str = ""


FIRST = {
    "angle": First(300, 300),
    "ratio": First(300, 300),
    "displacement": First(300, 300),
    "bearing": First(300, 300),
    "bearing-undirected": First(300, 300),
    "distance": First(16, 300),
    "distance-undirected": First(26, 300),
    "area": First(300, 300),
    "area-undirected": First(300, 300),
    "persistent": First(15, 300),
    "cosine": First(11, 300, "there 64 % still crept after 600 s; here the horizon is 120 s"),
    "cosine (Laman)": First(9, 300, "its 18 edges are not on record, nor how long it ran"),
    "triangular": First(300, 300),
    "triangular (Laman)": First(300, 300),
    "bisector": First(1, 300, "the order in which it placed the agents is not on record; another order is another law"),
    "bisector (wrapped)": First(210, 300, "the order of its agents is not on record"),
    "laplacian (cycles, D designed)": First(300, 300),
    "laplacian (cycles, D = 1)": First(0, 300),
    "affine": First(0, 300),
    "triangle-angles": First(510, 1000),
    "triangle-mixed": First(510, 1000),
}
"""By the row's name."""


def interval(reached: int, runs: int, normal: float = NORMAL) -> tuple[float, float]:
    """Wilson's interval of a share, of 95 % unless told.

    >>> [round(bound, 4) for bound in interval(0, 1000)]
    [0.0, 0.0038]
    """
    share, spread = reached / runs, normal**2 / runs
    middle = (share + spread / 2.0) / (1.0 + spread)
    half = normal * sqrt(share * (1.0 - share) / runs + spread / runs / 4.0) / (1.0 + spread)
    return max(0.0, middle - half), min(1.0, middle + half)


@dataclass(frozen=True)
class Beside:
    """A row's share beside the first one.

    Attributes:
        name: of the row.
        first, here: shares.
        low, high: 99.9 % interval of their difference (Newcombe's, from both Wilson intervals).
        why: what explains a difference.
    """

    name: str
    first: float
    here: float
    low: float
    high: float
    why: str

    @property
    def agree(self) -> bool:
        """Whether no difference lies in the interval."""
        return self.low <= 0.0 <= self.high


def beside(counts: dict[str, tuple[int, int]]) -> Iterator[Beside]:
    """Each row that has a first share, from how many of how many runs are right here, by name."""
    for name, (reached, runs) in counts.items():
        if name not in FIRST:
            continue
        first = FIRST[name]
        before, here = first.right / first.runs, reached / runs
        lows, highs = zip(interval(reached, runs, STRICT), interval(first.right, first.runs, STRICT), strict=True)
        change = here - before
        low = change - hypot(here - lows[0], highs[1] - before)
        high = change + hypot(highs[0] - here, before - lows[1])
        yield Beside(name, before, here, low, high, first.why)
