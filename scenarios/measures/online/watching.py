"""What a watch keeps of the states that pass, compiled: the closest pair, the last state beyond the goal, and flags.

What rounding could decide either way is not decided here: such a run is measured from its trajectory.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled
from robots.worlds.lanes import LEFT, PX, PY, RIGHT, X, Y

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

_NEARLY = 1.0 + 1e-14  # of squared distances: what is within may be the shortest, once it is rounded


class Angles(NamedTuple):
    """The angles that are compared.

    Attributes:
        triples: (m, 3) rows (v, a, b).
        cosines, sines: (m,) of their targets.
        goal: bound on the sum of the absolute errors, radians.
        doubt: radians within which of the goal nothing is decided.
    """

    triples: Index
    cosines: Real
    sines: Real
    goal: float
    doubt: float


@compiled
def nearest(rows: Real, least: Real) -> None:
    """Lower ``least`` (L,), metres, to the distance of the closest pair of points in states (K, F, n, L)."""
    _, _, n, runs = rows.shape
    square = np.empty(runs)
    for k in range(len(rows)):
        x, y = rows[k, PX], rows[k, PY]
        square[:] = np.inf
        for i in range(n):
            for j in range(i + 1, n):
                for m in range(runs):
                    dx, dy = x[i, m] - x[j, m], y[i, m] - y[j, m]
                    square[m] = min(square[m], dx * dx + dy * dy)
        for m in range(runs):
            if square[m] <= least[m] * least[m] * _NEARLY:
                least[m] = _closest(x[:, m], y[:, m], square[m] * _NEARLY, least[m])


@compiled
def _closest(x: Real, y: Real, square: float, least: float) -> float:
    """The least of ``least`` and the distances of pairs whose square is at most ``square``, as numpy rounds them."""
    for i in range(len(x)):
        for j in range(i + 1, len(x)):
            dx, dy = x[i] - x[j], y[i] - y[j]
            if dx * dx + dy * dy <= square:
                least = min(least, math.hypot(dx, dy))
    return least


@compiled
def beyond_floor(rows: Real, floor: Real, found: Flags) -> None:
    """Flag the runs (L,) in which an axle is off the floor (x_low, x_high, y_low, y_high)."""
    for k in range(len(rows)):
        for i in range(rows.shape[2]):
            for m in range(rows.shape[3]):
                x, y = rows[k, X, i, m], rows[k, Y, i, m]
                within = (x >= floor[0]) & (x <= floor[1]) & (y >= floor[2]) & (y <= floor[3])
                found[m] = found[m] | (not within)


@compiled
def beyond_wheels(rows: Real, limit: float, found: Flags) -> None:
    """Flag the runs (L,) in which a wheel turns faster than ``limit``, rad/s."""
    for k in range(len(rows)):
        for i in range(rows.shape[2]):
            for m in range(rows.shape[3]):
                fast = (abs(rows[k, LEFT, i, m]) > limit) | (abs(rows[k, RIGHT, i, m]) > limit)
                found[m] = found[m] | fast


@compiled
def last_above(rows: Real, first: int, angles: Angles, last: Index, doubtful: Flags) -> None:
    """Set ``last`` (L,) to the last state in which the error sum is not below the goal, where there is one.

    States are looked at from the last one, and no further back than needed; bounds of the errors, without the arc
    tangent, decide nearly all.

    Args:
        rows: (K, F, n, L) states.
        first: number of the first of them.
        doubtful: (L,) set where the sum is too near to the goal.
    """
    runs = rows.shape[3]
    open_ = np.ones(runs, np.bool_)
    low, high = np.empty(runs), np.empty(runs)
    for k in range(len(rows) - 1, -1, -1):
        x, y = rows[k, PX], rows[k, PY]
        _bounds(x, y, angles, low, high)
        left = 0
        for m in range(runs):
            if open_[m] and not high[m] < angles.goal - angles.doubt:
                if low[m] > angles.goal + angles.doubt:
                    above = True
                else:
                    error = _error_sum(x[:, m], y[:, m], angles)
                    above = not error < angles.goal
                    doubtful[m] = doubtful[m] or abs(error - angles.goal) <= angles.doubt
                if above:
                    last[m] = first + k
                    open_[m] = False
            left += open_[m]
        if left == 0:
            break


@compiled
def _bounds(x: Real, y: Real, angles: Angles, low: Real, high: Real) -> None:
    """Bounds of the sum of the absolute errors: b / (a + b) <= |atan2(b, a)| <= b / a for a >= 0, b >= 0."""
    low[:], high[:] = 0.0, 0.0
    for q in range(len(angles.triples)):
        v, a, b = angles.triples[q, 0], angles.triples[q, 1], angles.triples[q, 2]
        cosine, sine = angles.cosines[q], angles.sines[q]
        for m in range(len(low)):
            real, imag = _turned(
                x[a, m] - x[v, m], y[a, m] - y[v, m], x[b, m] - x[v, m], y[b, m] - y[v, m], cosine, sine
            )
            imag = abs(imag)
            ahead = real > 0.0
            low[m] += imag / (real + imag) if ahead else 1.0
            high[m] += imag / real if ahead else np.inf


@compiled
def _error_sum(x: Real, y: Real, angles: Angles) -> float:
    """The sum of the absolute angle errors, radians; NaN where an angle does not exist."""
    total = 0.0
    for q in range(len(angles.triples)):
        v, a, b = angles.triples[q, 0], angles.triples[q, 1], angles.triples[q, 2]
        ax, ay, bx, by = x[a] - x[v], y[a] - y[v], x[b] - x[v], y[b] - y[v]
        real, imag = _turned(ax, ay, bx, by, angles.cosines[q], angles.sines[q])
        total += np.nan if real == 0.0 and imag == 0.0 else abs(math.atan2(imag, real))
    return total


@compiled
def _turned(ax: float, ay: float, bx: float, by: float, cosine: float, sine: float) -> tuple[float, float]:
    """A complex number whose argument is the angle from a to b less the target."""
    real, imag = bx * ax + by * ay, by * ax - bx * ay
    return real * cosine + imag * sine, imag * cosine - real * sine
