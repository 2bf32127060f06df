"""Who may be near whom, compiled: everybody in a small crowd, the robots of nine cells of a grid in a large one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled

Real = NDArray[np.float64]
Index = NDArray[np.int64]

LARGE = 64
"""Robots from which on a grid is worth while; a state of so many holds one run."""

_FARTHEST = 1e9  # cells from the origin, beyond which all share one: numbers of cells stay exact


@compiled
def fill_grid(x: Real, y: Real, side: float, cells: Index, first: Index, order: Index) -> None:
    """Sort robots at x and y (n,) into cells of a side, metres: ``order[first[b]:first[b + 1]]`` is bucket b.

    Cells are hashed into buckets, which keeps the grid as small as the crowd, however far a robot strays. A robot
    without a finite position is in no bucket: nobody can sense it.

    Args:
        cells: (n, 3) out: column, row and bucket of each robot, -1 for none.
        first: (2^k + 1,) out.
        order: (n,) out.
    """
    n, size = len(cells), len(first) - 1
    first[:] = 0
    for i in range(n):
        cells[i, 2] = -1
        if math.isfinite(x[i]) and math.isfinite(y[i]):
            cells[i, 0], cells[i, 1] = _cell(x[i], side), _cell(y[i], side)
            cells[i, 2] = _bucket(cells[i, 0], cells[i, 1], size)
            first[cells[i, 2]] += 1
    for b in range(size):
        first[b + 1] += first[b]
    for i in range(n - 1, -1, -1):
        b = cells[i, 2]
        if b >= 0:
            first[b] -= 1  # from the end of the bucket down to its start
            order[first[b]] = i


@compiled
def around(x: float, y: float, side: float, i: int, cells: Index, first: Index, order: Index, found: Index) -> int:
    """Write the robots of the nine cells around robot i at (x, y) into ``found``, cell by cell; their number."""
    size, count = len(first) - 1, 0
    if not (math.isfinite(x) and math.isfinite(y)):
        return 0
    column, line = _cell(x, side), _cell(y, side)
    for cell in range(9):
        cx, cy = column + cell % 3 - 1, line + cell // 3 - 1
        b = _bucket(cx, cy, size)
        for place in range(first[b], first[b + 1]):
            j = order[place]
            if j != i and cells[j, 0] == cx and cells[j, 1] == cy:
                found[count] = j
                count += 1
    return count


@compiled
def in_rows(found: Index, count: int) -> None:
    """Put the first ``count`` robots of ``found`` into the order of rows."""
    for last in range(1, count):
        j, into = found[last], last
        while into > 0 and found[into - 1] > j:
            found[into] = found[into - 1]
            into -= 1
        found[into] = j


@compiled
def others(i: int, n: int, found: Index) -> int:
    """Write all robots but i into ``found``; their number."""
    count = 0
    for j in range(n):
        if j != i:
            found[count] = j
            count += 1
    return count


@compiled
def _cell(coordinate: float, side: float) -> int:
    return math.floor(min(max(coordinate / side, -_FARTHEST), _FARTHEST))


@compiled
def _bucket(cx: int, cy: int, size: int) -> int:
    return ((cx * 73856093) ^ (cy * 19349663)) & (size - 1)
