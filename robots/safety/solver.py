"""The exact solver of a problem in two variables, compiled.

A row (a_x, a_y, b) of the arrays below is the half-plane a.u >= b with |a| = 1. The first :data:`WHEEL_ROWS` rows are
hard: the sides of the wheels' diamond.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, inlined

Real = NDArray[np.float64]
Count = int | np.int64

WHEEL_ROWS = 4
"""The diamond |u_x| + r |u_y| <= L has four sides."""

_PARALLEL = 1e-12  # sine of the angle between two rows that are taken as parallel

TIGHT = 1e-12
"""m/s by which rounding may break a row."""

RELAXED = 1e-9
"""m/s below which a relaxation is rounding."""


@compiled
def _interval(rows: Real, count: Count, px: float, py: float, tx: float, ty: float) -> tuple[float, float, bool]:
    """The part [low, high] of the line p + s t that satisfies the first ``count`` rows, and whether there is one."""
    low, high = -np.inf, np.inf
    for j in range(count):
        slope = rows[j, 0] * tx + rows[j, 1] * ty
        gap = rows[j, 2] - rows[j, 0] * px - rows[j, 1] * py
        if abs(slope) <= _PARALLEL:
            if gap > TIGHT:
                return 0.0, 0.0, False
        elif slope > 0.0:
            low = max(low, gap / slope)
        else:
            high = min(high, gap / slope)
    if low > high:
        if low - high > TIGHT:
            return 0.0, 0.0, False
        low = high = 0.5 * (low + high)  # three rows through one point, up to rounding
    return low, high, True


@compiled
def _nearest(rows: Real, count: Count, x0: float, y0: float) -> tuple[float, float, bool]:
    """The point nearest to (x0, y0) that satisfies the first ``count`` rows, and whether there is one.

    Incremental (Seidel 1991): while a row holds at the optimum of the rows before it nothing changes; when it does not,
    the new optimum lies on its line, and the rows before it leave an interval of that line.
    """
    x, y = x0, y0
    for i in range(count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if ax * x + ay * y >= b - TIGHT:
            continue
        to_line = b - ax * x0 - ay * y0
        px, py = x0 + to_line * ax, y0 + to_line * ay
        low, high, found = _interval(rows, i, px, py, -ay, ax)
        if not found:
            return x, y, False
        s = min(max(0.0, low), high)
        x, y = px - s * ay, py + s * ax
    return x, y, True


@compiled
def _farthest(rows: Real, count: Count, cx: float, cy: float, x: float, y: float) -> tuple[float, float]:
    """The point farthest along c that satisfies the first ``count`` rows, given the one (x, y) of the wheel rows."""
    for i in range(WHEEL_ROWS, count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if ax * x + ay * y >= b - TIGHT:
            continue
        to_line = b - ax * x - ay * y
        px, py = x + to_line * ax, y + to_line * ay
        low, high, found = _interval(rows, i, px, py, -ay, ax)
        if not found:  # only rounding can get here: the caller's rows have a common point
            continue
        along = cy * ax - cx * ay
        s = high if along > 0.0 else low
        x, y = px - s * ay, py + s * ax
    return x, y


@compiled
def _least_relaxation(
    rows: Real, count: Count, work: Real, speed: float, weight: float, x: float, y: float
) -> tuple[float, float, float]:
    """The point within the wheels' diamond that breaks the other rows least, and by how much, m/s.

    Incremental in the three variables u and delta, rows a.u >= b - delta: when a row is broken at (u, delta), the new
    optimum has delta = b - a.u, which leaves a linear programme in u.

    Args:
        rows: the rows, wheel rows first.
        count: how many there are.
        work: scratch of the shape of ``rows``.
        speed, weight: L and r of the diamond.
        x, y: a point of the diamond.
    """
    delta = 0.0
    for side in range(WHEEL_ROWS):
        work[side, 0], work[side, 1], work[side, 2] = rows[side, 0], rows[side, 1], rows[side, 2]
    for i in range(WHEEL_ROWS, count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if b - ax * x - ay * y <= delta + TIGHT:
            continue
        used = np.int64(WHEEL_ROWS)
        for j in range(WHEEL_ROWS, i):
            dx, dy = rows[j, 0] - ax, rows[j, 1] - ay
            length = np.hypot(dx, dy)
            if length > _PARALLEL:  # of two parallel rows the later one is the stricter, it is broken
                work[used, 0], work[used, 1], work[used, 2] = dx / length, dy / length, (rows[j, 2] - b) / length
                used += 1
        if abs(ax) * weight >= abs(ay):
            corner_x, corner_y = np.copysign(speed, ax), 0.0
        else:
            corner_x, corner_y = 0.0, np.copysign(speed / weight, ay)
        x, y = _farthest(work, used, ax, ay, corner_x, corner_y)
        delta = max(delta, b - ax * x - ay * y)
    return x, y, delta


@compiled
def wheel_rows(rows: Real, speed: float, weight: float) -> None:
    """Write the sides of the diamond |u_x| + weight |u_y| <= speed into the first rows."""
    norm = np.hypot(1.0, weight)
    for side in range(WHEEL_ROWS):
        rows[side, 0] = (1.0 if side % 2 else -1.0) / norm
        rows[side, 1] = (weight if side // 2 else -weight) / norm
        rows[side, 2] = -speed / norm


@inlined
def within_wheels(vx: float, vy: float, gx: float, gy: float, speed: float, weight: float) -> float:
    """The largest s <= 1 with v + s g in the wheels' diamond; 0 if v itself is not and g does not lead back."""
    s = 1.0
    for side in range(WHEEL_ROWS):
        sign_x = 1.0 if side % 2 else -1.0
        sign_y = weight if side // 2 else -weight
        room = speed - sign_x * vx - sign_y * vy
        slope = sign_x * gx + sign_y * gy
        share = room / slope if room > 0.0 else 0.0
        s = min(s, share) if slope > room else s
    return s


@compiled
def project(
    rows: Real, count: Count, work: Real, speed: float, weight: float, x0: float, y0: float
) -> tuple[float, float, float]:
    """The point nearest to (x0, y0) that satisfies the rows; the least relaxation if none does.

    Args:
        rows: (m, 3) unit rows, the first of them from :func:`wheel_rows`. Where no point satisfies all, the thresholds
            of all others are lowered by the relaxation.
        count: how many rows there are.
        work: scratch of the shape of ``rows``.
        speed, weight: L in m/s and r of the diamond.
        x0, y0: the point wished for, m/s.

    Returns:
        The point, m/s, and the relaxation: 0, or the least by which all rows but the wheels' are to be lowered, m/s.
    """
    x, y, found = _nearest(rows, count, x0, y0)
    if found:
        return x, y, 0.0
    x, y, _ = _nearest(rows, np.int64(WHEEL_ROWS), x0, y0)
    x, y, delta = _least_relaxation(rows, count, work, speed, weight, x, y)
    for i in range(WHEEL_ROWS, count):
        rows[i, 2] -= delta
    nearer_x, nearer_y, found = _nearest(rows, count, x0, y0)
    if found:
        x, y = nearer_x, nearer_y
    return x, y, delta if delta > RELAXED else 0.0
