"""The closest pair of many points, state after state: exact, in nearly linear time.

A sweep along the longer axis of the crowd finds it: points in their order along that axis, each compared with the ones
ahead of it that are nearer along the axis than the closest pair so far. From one state to the next the order hardly
changes and the last closest pair is nearly the closest, so both carry over. Crowds that hide their distances from an
axis, two columns of points for instance, would make a sweep compare all pairs; after a number of comparisons
proportional to the number of points it gives way to the randomised grid of Golin, Raman, Schwarz and Smid (1995), whose
expected time is linear for whatever crowd. All ways give the same pair: of several equally close the first in the order
of rows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, program

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Pair = tuple[float, int, int]

_COMPARISONS = 16  # of each point on the average, after which a sweep gives way to the grid
_SHIFTS = 4  # of each point on the average, after which insertion gives way
_SLACK = 1.0 + 1e-12  # of squared distances, so that rounding prunes no pair


class Room(NamedTuple):
    """Where the search works.

    Attributes:
        order: (2, n) rows along x and along y, as the last state left them.
        counts: (n + 1,) of rows in places, for sorting.
        spread: (2,) of the points along x and along y.
        first, after: (2^k,), (n,) the cells of a grid.
    """

    order: Index
    counts: Index
    spread: Real
    first: Index
    after: Index


def closest_pairs(points: Real) -> Index:
    """(T, 2) rows of the closest pair of every state, the smaller row first.

    Args:
        points: (T, n, 2) metres, n at least 2. Of a state in which a distance is NaN, the first such pair is given.
    """
    n = points.shape[1]
    pairs = np.empty((len(points), 2), np.int64)
    shuffled = np.random.default_rng(0).permutation(n)
    room = Room(
        order=np.stack([shuffled, shuffled]),
        counts=np.empty(n + 1, np.int64),
        spread=np.empty(2),
        first=np.empty(2 ** (2 * n - 1).bit_length(), np.int64),
        after=np.empty(n, np.int64),
    )
    _closest_pairs(np.ascontiguousarray(points), shuffled, room, pairs)
    return pairs


@program
def _closest_pairs(points: Real, shuffled: Index, room: Room, pairs: Index) -> None:
    order, count, spread = room.order, room.counts, room.spread
    best = (np.inf, 0, 1)
    for row in range(len(points)):
        p = points[row]
        for each in range(2):
            spread[each] = _spread(p, each)
        if not math.isfinite(spread[0] + spread[1]):
            best = _all_pairs(p)
        else:
            axis = 1 if spread[1] > spread[0] else 0
            best = _apart(p, best[1], best[2])
            _sort(p, axis, order[axis], count)
            best, whole = _sweep(p, order[axis], axis, best)
            if not whole:
                # Cells are numbered exactly up to 2^52.
                far = _reach(p) > best[0] * 2.0**52
                if best[0] == 0.0:
                    best = _coincident(p, room.after)
                else:
                    best = _all_pairs(p) if far else _grid(p, shuffled, best, room.first, room.after)
        pairs[row, 0], pairs[row, 1] = best[1], best[2]


@compiled
def _spread(p: Real, axis: int) -> float:
    """Metres from the first to the last point along an axis; infinite where one is not finite."""
    low, high = p[0, axis], p[0, axis]
    for i in range(len(p)):
        if not math.isfinite(p[i, axis]):
            return np.inf
        low, high = min(low, p[i, axis]), max(high, p[i, axis])
    return high - low


@compiled
def _reach(p: Real) -> float:
    reach = 0.0
    for i in range(len(p)):
        reach = max(reach, abs(p[i, 0]), abs(p[i, 1]))
    return reach


@compiled
def _apart(p: Real, i: int, j: int) -> Pair:
    i, j = min(i, j), max(i, j)
    return math.hypot(p[i, 0] - p[j, 0], p[i, 1] - p[j, 1]), i, j


@compiled
def _closer(one: Pair, other: Pair) -> bool:
    """Whether ``one`` is closer, or as close and earlier in the order of rows."""
    return one[0] < other[0] or (one[0] == other[0] and (one[1], one[2]) < (other[1], other[2]))


@compiled
def _all_pairs(p: Real) -> Pair:
    """By comparing all pairs, as numpy's argmin does: the first NaN is smallest."""
    best = (np.inf, 0, 1)
    for i in range(len(p)):
        for j in range(i + 1, len(p)):
            found = _apart(p, i, j)
            if math.isnan(found[0]):
                return found
            if found[0] < best[0]:
                best = found
    return best


@compiled
def _sort(p: Real, axis: int, order: Index, count: Index) -> None:
    """Sort ``order`` along an axis, in place: by insertion where it is nearly sorted, else after filling bins.

    ``count`` is scratch of n + 1 integers.
    """
    if _insertion(p, axis, order):
        return
    n = len(order)
    low, high = p[0, axis], p[0, axis]
    for i in range(n):
        low, high = min(low, p[i, axis]), max(high, p[i, axis])
    scale = (n - 1) / (high - low) if high > low else 0.0
    if math.isfinite(scale):
        count[:] = 0
        for i in range(n):
            count[int((p[i, axis] - low) * scale) + 1] += 1
        for b in range(n):
            count[b + 1] += count[b]
        for i in range(n):
            b = int((p[i, axis] - low) * scale)
            order[count[b]] = i
            count[b] += 1
        if _insertion(p, axis, order):
            return
    _shell_sort(p, axis, order)


@compiled
def _insertion(p: Real, axis: int, order: Index) -> bool:
    """Sort ``order`` by insertion; False where it gave up, which leaves some permutation."""
    shifts = _SHIFTS * len(order)
    for k in range(1, len(order)):
        moved, place = order[k], k
        value = p[moved, axis]
        while place > 0 and p[order[place - 1], axis] > value:
            order[place] = order[place - 1]
            place -= 1
        order[place] = moved
        shifts -= k - place
        if shifts < 0:
            return False
    return True


@compiled
def _shell_sort(p: Real, axis: int, order: Index) -> None:
    """Sort ``order`` along an axis, then along the other one, then by row, in whatever order it is."""
    gap = 1
    while gap < len(order) // 9:
        gap = 3 * gap + 1
    while gap > 0:
        for k in range(gap, len(order)):
            moved, place = order[k], k
            while place >= gap and _before(p, axis, moved, order[place - gap]):
                order[place] = order[place - gap]
                place -= gap
            order[place] = moved
        gap //= 3


@compiled
def _before(p: Real, axis: int, i: int, j: int) -> bool:
    if p[i, axis] != p[j, axis]:
        return bool(p[i, axis] < p[j, axis])
    if p[i, 1 - axis] != p[j, 1 - axis]:
        return bool(p[i, 1 - axis] < p[j, 1 - axis])
    return i < j


@compiled
def _sweep(p: Real, order: Index, axis: int, best: Pair) -> tuple[Pair, bool]:
    """The closest pair and True; or, where it would take too long, some close pair and False."""
    left = _COMPARISONS * len(order)
    reach2 = best[0] * best[0] * _SLACK
    for k in range(len(order)):
        i = order[k]
        x, y = p[i, axis], p[i, 1 - axis]
        for ahead in range(k + 1, len(order)):
            j = order[ahead]
            dx, dy = p[j, axis] - x, p[j, 1 - axis] - y
            if dx * dx > reach2:
                break
            left -= 1
            if dx * dx + dy * dy <= reach2:
                found = _apart(p, i, j)
                if _closer(found, best):
                    best = found
                    reach2 = best[0] * best[0] * _SLACK
        if left < 0:
            return best, False
    return best, True


@compiled
def _grid(p: Real, order: Index, best: Pair, first: Index, after: Index) -> Pair:
    """The closest pair by inserting points in random order into cells as wide as the closest pair so far."""
    n, size = len(order), len(first)
    first[:] = -1
    side = best[0] * _SLACK
    k = 0
    while k < n and best[0] > 0.0:
        i = order[k]
        cx, cy = math.floor(p[i, 0] / side), math.floor(p[i, 1] / side)
        nearer = best
        for cell in range(9):
            j = first[_bucket(cx + cell % 3 - 1, cy + cell // 3 - 1, size)]
            while j >= 0:
                dx, dy = p[i, 0] - p[j, 0], p[i, 1] - p[j, 1]
                if dx * dx + dy * dy <= nearer[0] * nearer[0] * _SLACK:
                    found = _apart(p, i, j)
                    if _closer(found, nearer):
                        nearer = found
                j = after[j]
        shrunk = nearer[0] < best[0]
        best = nearer
        if shrunk and best[0] > 0.0:
            side = best[0] * _SLACK
            first[:] = -1
            for earlier in range(k):
                _insert(p, order[earlier], side, first, after)
        _insert(p, i, side, first, after)
        k += 1
    return best if best[0] > 0.0 else _coincident(p, after)


@compiled
def _insert(p: Real, i: int, side: float, first: Index, after: Index) -> None:
    b = _bucket(math.floor(p[i, 0] / side), math.floor(p[i, 1] / side), len(first))
    after[i] = first[b]
    first[b] = i


@compiled
def _bucket(cx: float, cy: float, size: int) -> int:
    return int(((np.int64(cx) * 73856093) ^ (np.int64(cy) * 19349663)) & (size - 1))


@compiled
def _coincident(p: Real, order: Index) -> Pair:
    """The first pair of equal points, where there is one; ``order`` (n,) is for use in between."""
    for i in range(len(p)):
        order[i] = i
    axis = min(len(p), 0)  # a variable, so that numba compiles the sort once
    _shell_sort(p, axis, order)  # equal points stand together, in the order of rows
    best = (0.0, len(p), len(p))
    for k in range(1, len(p)):
        i, j = order[k - 1], order[k]
        if p[i, 0] == p[j, 0] and p[i, 1] == p[j, 1] and (i, j) < (best[1], best[2]):
            best = (0.0, i, j)
    return best
