"""Barrier certificates as quadratic programs, solved exactly.

Wang, Ames, Egerstedt 2017, "Safety barrier certificates for collisions-free multirobot systems", as ``rps`` states
them: of all velocities the nearest to the wished ones with

    -2 e_ij.(v_i - v_j) <= gamma h^3,     h = |e_ij|^2 - D^2,     e_ij = c_i - c_j,      every pair,
    -n.v_i <= 0.4 gamma (d - D / 2)^3,                                                   every side of a boundary,

d the distance from the side with the inward normal n. A program of many robots begins with the rows that the wish
breaks and takes in those that its solution breaks, until there are none: the solution is that of all rows.
"""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

from robots.rps.columns import Real
from robots.safety.certificate import BOUNDARY_SHARE

BROKEN = 1e-9
"""By how much a solution may break a row before the row is taken in."""

PENALTY = 1e6
"""Of a relaxation, against the squared distance from the wish: far above every multiplier."""

UNBOUNDED = 1e30

OCTAGON = np.array([[np.cos(angle), np.sin(angle)] for angle in np.arange(8) * np.pi / 4.0])
"""(8, 2) normals of the sides that stand for the circle of a speed limit, counter-clockwise from x."""


def nearest(wish: Real, rows: Real, bounds: Real, hard: NDArray[np.bool_], metric: Real | None = None) -> Real:
    """(k,) the x nearest to ``wish`` (k,) with ``rows`` (m, k) x <= ``bounds`` (m,).

    Args:
        wish: (k,).
        rows, bounds: of the inequalities.
        hard: (m,) which hold in any case. Where there is no x, the others are relaxed by the least uniform amount.
        metric: (k, k) positive definite W of the distance (x - wish)' W (x - wish); the identity where absent.
    """
    weight = np.eye(len(wish)) if metric is None else metric
    x = wish
    used = rows @ x > bounds
    while True:
        x = _solve(wish, rows[used], bounds[used], hard[used], weight) if used.any() else wish
        broken = ~used & (rows @ x > bounds + BROKEN)
        if not broken.any():
            return x
        used |= broken


def feasible(wish: Real, rows: Real, bounds: Real) -> Real | None:
    """(k,) the x nearest to ``wish`` (k,) with ``rows`` x <= ``bounds``, or None where there is none."""
    x, flag = _daqp(np.eye(len(wish)), -wish, rows, bounds)
    return x if flag == 1 else None


def pairs(n: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first and the second robot of each pair."""
    first, second = np.triu_indices(n, 1)
    return first, second


def pair_rows(points: Real) -> tuple[Real, Real]:
    """(m, 2N) rows -2 e_ij.(v_i - v_j) of all pairs of points (2, N), metres, and (m,) their squared distances."""
    n = points.shape[1]
    first, second = pairs(n)
    e = (points[:, first] - points[:, second]).T
    rows = np.zeros((len(first), n, 2))
    each = np.arange(len(first))
    rows[each, first], rows[each, second] = -2.0 * e, 2.0 * e
    return rows.reshape(-1, 2 * n), (e**2).sum(axis=1)


def boundary_rows(points: Real, boundary: Real, distance: float, gain: float) -> tuple[Real, Real]:
    """(4N, 2N) rows -n.v_i and (4N,) their bounds at the sides x low, x high, y low, y high of a boundary, metres."""
    n = points.shape[1]
    low_x, high_x, low_y, high_y = np.asarray(boundary, dtype=np.float64)
    outward = np.array([[0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0]])
    x, y = points
    gap = np.array([high_y - y, y - low_y, high_x - x, x - low_x]).T - distance / 2.0
    return np.kron(np.eye(n), outward), BOUNDARY_SHARE * gain * gap.ravel() ** 3


def _solve(wish: Real, rows: Real, bounds: Real, hard: NDArray[np.bool_], weight: Real) -> Real:
    x, flag = _daqp(weight, -weight @ wish, rows, bounds)
    if flag == 1:
        return x
    k = len(wish)
    slack = np.concatenate([np.where(hard, 0.0, -1.0), [-1.0]])  # the last row: the relaxation is not negative
    relaxed = np.column_stack([np.concatenate([rows, np.zeros((1, k))]), slack])
    both = np.zeros((k + 1, k + 1))
    both[:k, :k], both[k, k] = weight, 1.0
    x, _ = _daqp(both, np.append(-weight @ wish, PENALTY), relaxed, np.append(bounds, 0.0))
    return x[:k]


def _daqp(h: Real, f: Real, rows: Real, bounds: Real) -> tuple[Real, int]:
    none = np.zeros(len(bounds), dtype=np.int32)
    x, _, flag, _ = daqp.solve(
        np.ascontiguousarray(h), np.ascontiguousarray(f), np.ascontiguousarray(rows), bounds + 0.0,
        np.full(len(bounds), -UNBOUNDED), none,
    )  # fmt: skip
    return np.asarray(x), int(flag)
