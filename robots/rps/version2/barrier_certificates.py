"""Barrier certificates as in ``rps`` 2.1: see :mod:`robots.rps.certificates`.

Speeds stay in an octagon within the circle of their limit. One robot alone gets back what it wished, as there. Where
``rps`` finds no solution and stops all robots, the rows are relaxed by the least amount that leaves one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from robots.rps.certificates import OCTAGON, boundary_rows, feasible, nearest, pair_rows
from robots.rps.columns import Real, ahead, columns
from robots.rps.version2.transformations import Map, create_si_to_uni_mapping, create_uni_to_si_mapping

BOUNDARY = (-1.7, 1.7, -1.1, 1.1)
"""x low, x high, y low, y high, metres: 0.1 m beyond the floor."""

FLOOR = (-1.6, 1.6, -1.0, 1.0)
"""The same of the floor."""

INNER = np.cos(np.pi / 8.0)
"""Of an octagon within the unit circle, from its centre to its sides."""


class UnicycleCertificate(Protocol):
    """A certificate that may be told of obstacles."""

    def __call__(self, dxu: Real, x: Real, obstacles: Real | None = None) -> Real: ...


def create_si_barrier_certificate(
    safety_radius: float = 0.15, barrier_gain: float = 100.0, magnitude_limit: float = 0.2
) -> Map:
    """Between robots. The octagon's side towards +x lies at the limit itself, as there.

    Args:
        safety_radius: D, metres between two robots.
        barrier_gain: gamma, 1/(m^4 s).
        magnitude_limit: m/s.

    Returns:
        A function of wished velocities (2, N), m/s, and positions or poses (2 or 3, N) that gives the nearest safe
        velocities (2, N).
    """
    sides = np.full(len(OCTAGON), magnitude_limit * INNER)
    sides[0] = magnitude_limit
    return _certificate(safety_radius, barrier_gain, sides, None)


def create_si_barrier_certificate_with_boundary(
    safety_radius: float = 0.15,
    barrier_gain: float = 100.0,
    magnitude_limit: float = 0.2,
    boundary_points: ArrayLike | None = None,
) -> Map:
    """Between robots, and within a boundary.

    Args:
        safety_radius: D, metres between two robots.
        barrier_gain: gamma, 1/(m^4 s).
        magnitude_limit: m/s that no robot exceeds.
        boundary_points: x low, x high, y low, y high, metres; 0.1 m beyond the floor where absent.

    Returns:
        A function of wished velocities (2, N), m/s, and positions or poses (2 or 3, N) that gives the nearest safe
        velocities (2, N).
    """
    sides = np.full(len(OCTAGON), magnitude_limit * INNER)
    boundary = np.asarray(BOUNDARY if boundary_points is None else boundary_points, dtype=np.float64)
    return _certificate(safety_radius, barrier_gain, sides, boundary)


def create_uni_barrier_certificate(
    barrier_gain: float = 100.0,
    safety_radius: float = 0.15,
    projection_distance: float = 0.05,
    velocity_magnitude_limit: float = 0.2,
) -> Map:
    """:func:`create_si_barrier_certificate` for the points ahead, twice their distance further apart.

    Args:
        barrier_gain: 1/(m^4 s).
        safety_radius: metres between two axles.
        projection_distance: metres from the axle to the point.
        velocity_magnitude_limit: m/s, of the point.

    Returns:
        A function of wished commands (2, N) and poses (3, N) that gives safe commands (2, N).
    """
    distance = safety_radius + 2.0 * projection_distance
    between = _unicycle(
        create_si_barrier_certificate(distance, barrier_gain, velocity_magnitude_limit), projection_distance
    )

    def barrier_unicycle(dxu: Real, x: Real) -> Real:
        return between(dxu, x)

    return barrier_unicycle


def create_uni_barrier_certificate_with_boundary(
    safety_radius: float = 0.12,
    barrier_gain: float = 150.0,
    projection_distance: float = 0.03,
    velocity_magnitude_limit: float = 0.2,
    boundary_points: ArrayLike | None = None,
) -> UnicycleCertificate:
    """:func:`create_si_barrier_certificate_with_boundary` for the points ahead, twice their distance further apart.

    Args:
        safety_radius: metres between two axles.
        barrier_gain: 1/(m^4 s).
        projection_distance: metres from the axle to the point.
        velocity_magnitude_limit: m/s, of the point.
        boundary_points: x low, x high, y low, y high, metres, of the points; the floor where absent.

    Returns:
        A function of wished commands (2, N), poses (3, N) and point obstacles (2, M), metres, if there are any, that
        gives safe commands (2, N). Obstacles stand: in ``rps`` they are robots that make way.
    """
    distance = safety_radius + 2.0 * projection_distance
    boundary = FLOOR if boundary_points is None else boundary_points
    sides = np.full(len(OCTAGON), velocity_magnitude_limit * INNER)
    return _unicycle(
        _certificate(distance, barrier_gain, sides, np.asarray(boundary, dtype=np.float64)), projection_distance
    )


def _certificate(distance: float, gain: float, sides: Real, boundary: Real | None) -> Callable[..., Real]:
    """A certificate between points, in a boundary if there is one, with the octagon's ``sides`` (8,), m/s."""

    def certificate(dxi: Real, x: Real, obstacles: Real | None = None) -> Real:
        n = np.shape(dxi)[1]
        if n < 2:
            return dxi
        wish, points = columns("dxi", dxi, 2), columns("x", np.asarray(x)[:2], 2, n)
        others = np.empty((2, 0)) if obstacles is None or not np.size(obstacles) else columns("obstacles", obstacles, 2)
        rows, squared = pair_rows(np.concatenate([points, others], axis=1))
        mine = np.flatnonzero(np.abs(rows[:, : 2 * n]).any(axis=1))
        parts = [(rows[mine, : 2 * n], gain * (squared[mine] - distance**2) ** 3)]
        if boundary is not None:
            parts.append(boundary_rows(points, boundary, distance, gain))
        soft = sum(len(bounds) for _, bounds in parts)
        parts.append((np.kron(np.eye(n), OCTAGON), np.tile(sides, n)))
        matrix, bounds = (np.concatenate(each) for each in zip(*parts, strict=True))
        return nearest(wish.T.ravel(), matrix, bounds, np.arange(len(bounds)) >= soft).reshape(n, 2).T

    return certificate


def _unicycle(certificate: Callable[..., Real], projection_distance: float) -> UnicycleCertificate:
    to_commands, _ = create_si_to_uni_mapping(projection_distance)
    to_velocities, _ = create_uni_to_si_mapping(projection_distance)

    def barrier_unicycle(dxu: Real, x: Real, obstacles: Real | None = None) -> Real:
        if np.shape(dxu)[1] < 2:
            return dxu
        poses = columns("x", x, 3, np.shape(dxu)[1])
        wish, points = to_velocities(dxu, poses), ahead(poses, projection_distance)
        given = () if obstacles is None else (obstacles,)
        return to_commands(certificate(wish, points, *given), poses)

    return barrier_unicycle


def _solve_qp(N: int, vhat: Real, A: Real, b: Real) -> Real | None:  # noqa: N803 (an example of rps calls it)
    """(2, N) the velocities nearest to ``vhat`` with ``A`` v <= ``b``, robot by robot, or None where there are none."""
    wish = np.asarray(vhat, dtype=np.float64).reshape(-1, order="F")
    solution = feasible(wish, np.asarray(A, dtype=np.float64), np.asarray(b, dtype=np.float64))
    return None if solution is None else solution.reshape(N, 2).T
