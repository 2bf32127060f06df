"""What a watch keeps of the states that pass, compiled: the closest pair, the last state beyond the goal, and flags.

States pass in chunks. From the wheels follows how far robots can have gone within one: where that is too little to
matter, the last state of the chunk tells of all. What rounding could decide either way is not decided here: such a run
is measured from its trajectory.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, inlined, program
from robots.worlds.lanes import LEFT, PX, PY, RIGHT, X, Y

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

_NEARLY = 1.0 + 1e-14  # of squared distances: what is within may be the shortest, once it is rounded
_ROUNDED = 1e-9  # share and metres by which a way may be longer than wheels tell


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


class Ground(NamedTuple):
    """What robots drive on, and how.

    Attributes:
        floor: (x_low, x_high, y_low, y_high), metres.
        way: metres that any point of interest of a robot goes in a period at most, for each rad/s of its faster wheel.
    """

    floor: Real
    way: float


class Seen(NamedTuple):
    """What is known of each run (L,).

    Attributes:
        last_above: number of the last state in which the error sum is not below the goal; -1 for none.
        doubtful: whether a sum was too near to the goal to tell.
        least: distance of the closest pair, metres.
        off_floor: whether an axle was off the floor.
        fastest: of the wheels, rad/s.
    """

    last_above: Index
    doubtful: Flags
    least: Real
    off_floor: Flags
    fastest: Real


class Room(NamedTuple):
    """Where the watch works, (L,) each.

    Attributes:
        way: metres that a robot may have gone since a state.
        square: least squared distance of two robots, square metres.
        beyond: how far an axle is off the floor, metres.
        low, high: bounds of the error sum, radians.
        undecided: whether the last state above the goal may come earlier.
    """

    way: Real
    square: Real
    beyond: Real
    low: Real
    high: Real
    undecided: Flags


def room(runs: int) -> Room:
    """Room for so many runs."""
    way, square, beyond, low, high = np.empty((5, runs))
    return Room(way, square, beyond, low, high, np.empty(runs, dtype=bool))


@program
def look(rows: Real, checked: Real, first: int, angles: Angles, ground: Ground, seen: Seen, room: Room) -> None:
    """Look at a chunk of states.

    Args:
        rows: (K, F, n, L) states.
        checked: the same with the points that the testbed checks in the place of the projected ones.
        first: number of the first of them.
        seen: is brought up to date.
    """
    runs, way, square = rows.shape[3], room.way, room.square
    way[:] = 0.0
    _fastest(rows, way)
    for m in range(runs):
        seen.fastest[m] = max(seen.fastest[m], way[m])
        way[m] = way[m] * ground.way * (len(rows) - 1) * (1.0 + _ROUNDED) + _ROUNDED
    _beyond_floor(rows, ground.floor, way, room.beyond, seen.off_floor)
    _nearest(checked, way, square, seen.least)
    _last_above(rows, first, angles, room, seen.last_above, seen.doubtful)


@compiled
def _fastest(rows: Real, fastest: Real) -> None:
    """Raise ``fastest`` (L,) to the speed of the fastest wheel, rad/s; NaN without wheels."""
    for k in range(len(rows)):
        for i in range(rows.shape[2]):
            left, right = rows[k, LEFT, i], rows[k, RIGHT, i]
            for m in range(len(fastest)):
                fastest[m] = max(max(abs(left[m]), abs(right[m])), fastest[m])


@compiled
def _beyond_floor(rows: Real, floor: Real, way: Real, beyond: Real, found: Flags) -> None:
    """Flag the runs in which an axle is off the floor; ``beyond`` (L,) is for use in between."""
    runs = len(found)
    beyond[:] = -np.inf
    _excess(rows[-1], floor, beyond)
    far = 0
    for m in range(runs):
        far += not (found[m] or beyond[m] + way[m] < 0.0)
    for k in range(len(rows) - 1 if far else 0):
        _excess(rows[k], floor, beyond)
    for m in range(runs):
        found[m] = found[m] | (not beyond[m] <= 0.0)


@compiled
def _excess(state: Real, floor: Real, beyond: Real) -> None:
    """Raise ``beyond`` (L,), metres, to how far an axle is off the floor; a number above 0 is exactly that."""
    x_low, x_high, y_low, y_high = floor[0], floor[1], floor[2], floor[3]
    for i in range(state.shape[1]):
        x, y = state[X, i], state[Y, i]
        for m in range(len(beyond)):
            off = max(max(x_low - x[m], x[m] - x_high), max(y_low - y[m], y[m] - y_high))
            beyond[m] = max(off, beyond[m])


@compiled
def _nearest(rows: Real, way: Real, square: Real, least: Real) -> None:
    """Lower ``least`` to the distance of the closest pair of points; ``square`` (L,) is for use in between."""
    far = _nearest_in(rows[-1], way, square, least)
    for k in range(len(rows) - 1 if far else 0):
        _nearest_in(rows[k], way, square, least)


@compiled
def _nearest_in(state: Real, way: Real, square: Real, least: Real) -> int:
    """The same of one state; in how many runs the closest pair ``way`` from there may be closer yet."""
    _squares(state, square)
    closer = 0
    for m in range(len(least)):
        if square[m] <= least[m] * least[m] * _NEARLY:
            least[m] = _closest(state[PX, :, m], state[PY, :, m], square[m] * _NEARLY, least[m])
        closer += not math.sqrt(square[m]) - 2.0 * way[m] > least[m]
    return closer


@compiled
def _squares(state: Real, square: Real) -> None:
    """Set ``square`` (L,), square metres, to the least squared distance of two points, but for rounding."""
    square[:] = np.inf
    for i in range(state.shape[1]):
        x, y = state[PX, i], state[PY, i]
        for j in range(i + 1, state.shape[1]):
            other_x, other_y = state[PX, j], state[PY, j]
            for m in range(len(square)):
                dx, dy = x[m] - other_x[m], y[m] - other_y[m]
                square[m] = min(square[m], dx * dx + dy * dy)


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
def _last_above(rows: Real, first: int, angles: Angles, room: Room, last: Index, doubtful: Flags) -> None:
    """Set ``last`` to the last state in which the error sum is not below the goal, where there is one.

    States are looked at from the last one, and no further back than needed; bounds of the errors, without the arc
    tangent, decide nearly all.
    """
    runs, before = rows.shape[3], len(rows) - 1
    way, square, low, high, undecided = room.way, room.square, room.low, room.high, room.undecided
    undecided[:] = True
    _decide(rows[before], first + before, angles, low, high, undecided, last, doubtful)
    _squares(rows[before], square)
    for m in range(runs):
        if high[m] + _drift(square[m], way[m], len(angles.triples)) < angles.goal - angles.doubt:
            undecided[m] = False
    while before > 0 and undecided.any():
        before -= 1
        _decide(rows[before], first + before, angles, low, high, undecided, last, doubtful)


@compiled
def _decide(
    state: Real, number: int, angles: Angles, low: Real, high: Real, undecided: Flags, last: Index, doubtful: Flags
) -> None:
    """Where that is undecided, and the error sum not below the goal, the state of this number was the last one."""
    x, y = state[PX], state[PY]
    _bounds(x, y, angles, low, high)
    for m in range(len(undecided)):
        if undecided[m] and not high[m] < angles.goal - angles.doubt:
            above = low[m] > angles.goal + angles.doubt
            if not above:
                error = _error_sum(x[:, m], y[:, m], angles)
                doubtful[m] = doubtful[m] or abs(error - angles.goal) <= angles.doubt
                above = not error < angles.goal
            if above:
                last[m], undecided[m] = number, False


@inlined
def _drift(square: float, way: float, angles: int) -> float:
    """How much the error sum changes at most while points, a distance apart whose square is given, go ``way`` each.

    Over a distance d, a bearing turns by 2 way / (d - 2 way) at most, and an angle by the turns of two bearings.
    """
    apart = math.sqrt(square) - 2.0 * way
    return 4.0 * angles * way / apart if apart > 0.0 else np.inf


@compiled
def _bounds(x: Real, y: Real, angles: Angles, low: Real, high: Real) -> None:
    """Bounds of the sum of the absolute errors: b / (a + b) <= |atan2(b, a)| <= b / a for a >= 0, b >= 0."""
    low[:], high[:] = 0.0, 0.0
    for q in range(len(angles.triples)):
        v, a, b = angles.triples[q, 0], angles.triples[q, 1], angles.triples[q, 2]
        cosine, sine = angles.cosines[q], angles.sines[q]
        xv, yv, xa, ya, xb, yb = x[v], y[v], x[a], y[a], x[b], y[b]
        for m in range(len(low)):
            real, imag = _turned(xa[m] - xv[m], ya[m] - yv[m], xb[m] - xv[m], yb[m] - yv[m], cosine, sine)
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
