"""Barrier certificates under the names of ``rps`` 1: the wish is cut to the speed limit, not the solution.

See :mod:`robots.rps.certificates` for the rows. Where ``rps`` finds no solution it goes on with what its solver has
reached; here the rows are relaxed by the least amount that leaves one. What is wished is left as it was. In 2018 the
first argument was the number of robots: by its name, ``number_of_agents``, it is taken and has no effect.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from robots.drive import DifferentialDrive
from robots.rps.certificates import boundary_rows, nearest, pair_rows, pairs
from robots.rps.columns import Real, ahead, columns, limited, positive
from robots.rps.version1.transformations import create_si_to_uni_mapping, create_uni_to_si_dynamics
from robots.rps.version2.barrier_certificates import FLOOR
from robots.rps.version2.transformations import Map

CORNERS = np.array([[-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, 1.0, -1.0]])
"""(2, 4) of the square of disturbances, left and right wheel."""


def create_single_integrator_barrier_certificate(
    barrier_gain: float = 100.0,
    safety_radius: float = 0.17,
    magnitude_limit: float = 0.2,
    *,
    number_of_agents: int | None = None,
) -> Map:
    """Between robots.

    Args:
        barrier_gain: gamma, 1/(m^4 s).
        safety_radius: D, metres between two robots.
        magnitude_limit: m/s, of the wish.
        number_of_agents: of 2018, without effect.

    Returns:
        A function of wished velocities (2, N), m/s, and positions (2, N) that gives the nearest safe ones (2, N).
    """
    return _certificate(safety_radius, barrier_gain, barrier_gain, magnitude_limit, None)


def create_single_integrator_barrier_certificate_with_boundary(
    barrier_gain: float = 100.0,
    safety_radius: float = 0.17,
    magnitude_limit: float = 0.2,
    boundary_points: ArrayLike = FLOOR,
) -> Map:
    """Between robots, and within x low, x high, y low, y high, metres."""
    boundary = np.asarray(boundary_points, dtype=np.float64)
    return _certificate(safety_radius, barrier_gain, barrier_gain, magnitude_limit, boundary)


def create_single_integrator_barrier_certificate2(
    barrier_gain: float = 100.0,
    unsafe_barrier_gain: float = 1e6,
    safety_radius: float = 0.17,
    magnitude_limit: float = 0.2,
) -> Map:
    """Between robots, with a gain of its own where two are closer than they should be."""
    positive(unsafe_barrier_gain=unsafe_barrier_gain)
    return _certificate(safety_radius, barrier_gain, unsafe_barrier_gain, magnitude_limit, None)


def create_unicycle_barrier_certificate(
    barrier_gain: float = 100.0,
    safety_radius: float = 0.12,
    projection_distance: float = 0.05,
    magnitude_limit: float = 0.2,
    *,
    number_of_agents: int | None = None,
) -> Map:
    """For the points ahead, their distance further apart. The limit of speed is 0.2 m/s whatever is asked, as there."""
    positive(magnitude_limit=magnitude_limit)
    between = create_single_integrator_barrier_certificate(barrier_gain, safety_radius + projection_distance)
    return _unicycle(between, projection_distance)


def create_unicycle_barrier_certificate_with_boundary(
    barrier_gain: float = 100.0,
    safety_radius: float = 0.12,
    projection_distance: float = 0.05,
    magnitude_limit: float = 0.2,
    boundary_points: ArrayLike = FLOOR,
) -> Map:
    """:func:`create_unicycle_barrier_certificate`, and within x low, x high, y low, y high, metres."""
    positive(magnitude_limit=magnitude_limit)
    within = create_single_integrator_barrier_certificate_with_boundary(
        barrier_gain, safety_radius + projection_distance, boundary_points=boundary_points
    )
    return _unicycle(within, projection_distance)


def create_unicycle_barrier_certificate2(
    barrier_gain: float = 500.0,
    unsafe_barrier_gain: float = 1e6,
    safety_radius: float = 0.12,
    projection_distance: float = 0.05,
    magnitude_limit: float = 0.2,
) -> Map:
    """:func:`create_unicycle_barrier_certificate` with a gain of its own where two are closer than they should be."""
    positive(magnitude_limit=magnitude_limit)
    between = create_single_integrator_barrier_certificate2(
        barrier_gain, unsafe_barrier_gain, safety_radius + projection_distance
    )
    return _unicycle(between, projection_distance)


def create_unicycle_differential_drive_barrier_certificate(
    max_num_obstacle_points: int = 100,
    max_num_robots: int = 30,
    disturbance: float = 5.0,
    wheel_vel_limit: float = 12.5,
    base_length: float = 0.105,
    wheel_radius: float = 0.016,
    projection_distance: float = 0.05,
    barrier_gain: float = 150.0,
    safety_radius: float = 0.17,
) -> Callable[..., Real]:
    """In wheel speeds, robust against disturbances of each wheel; without boundary.

    With l the projection distance, p the points ahead, G_i (2, 2) the map from robot i's wheel speeds u_i to the
    velocity of p_i, and S the square of disturbances:

        2 e_ij.(G_i u_i - G_j u_j) + min over S of 2 e_ij.G_i s + min over S of -2 e_ij.G_j s >= -gamma h^3,
        |u| <= limit,

    nearest to the wish in the velocities of the points.

    Args:
        max_num_obstacle_points, max_num_robots: without effect.
        disturbance: of each wheel, rad/s.
        wheel_vel_limit: rad/s.
        base_length, wheel_radius: metres.
        projection_distance: metres.
        barrier_gain: 1/(m^4 s).
        safety_radius: metres between two points.

    Returns:
        A function of wished commands (2, N), poses (3, N) and point obstacles (2, M), if there are any, that gives safe
        commands (2, N).
    """
    drive = DifferentialDrive(wheel_radius, base_length, wheel_vel_limit)
    return _robust(drive, disturbance, projection_distance, barrier_gain, safety_radius, None)


def create_unicycle_differential_drive_barrier_certificate_with_boundary(
    max_num_obstacle_points: int = 100,
    max_num_robots: int = 30,
    disturbance: float = 5.0,
    wheel_vel_limit: float = 12.5,
    base_length: float = 0.105,
    wheel_radius: float = 0.016,
    projection_distance: float = 0.05,
    barrier_gain: float = 150.0,
    safety_radius: float = 0.17,
    boundary_points: ArrayLike = FLOOR,
) -> Callable[..., Real]:
    """:func:`create_unicycle_differential_drive_barrier_certificate`, and within a boundary, there without disturbance.

    Args:
        boundary_points: x low, x high, y low, y high, metres.
    """
    drive = DifferentialDrive(wheel_radius, base_length, wheel_vel_limit)
    boundary = np.asarray(boundary_points, dtype=np.float64)
    return _robust(drive, disturbance, projection_distance, barrier_gain, safety_radius, boundary)


def _certificate(distance: float, gain: float, unsafe: float, limit: float, boundary: Real | None) -> Map:
    positive(barrier_gain=gain, safety_radius=distance, magnitude_limit=limit)

    def certificate(dxi: Real, x: Real) -> Real:
        wish = limited(columns("dxi", dxi, 2), limit)
        n = wish.shape[1]
        points = columns("x", np.asarray(x)[:2], 2, n)
        rows, squared = pair_rows(points)
        h = squared - distance**2
        bounds = np.where(h >= 0.0, gain, unsafe) * h**3
        if boundary is not None:
            walls, edges = boundary_rows(points, boundary, distance, gain)
            rows, bounds = np.concatenate([rows, walls]), np.concatenate([bounds, edges])
        return nearest(wish.T.ravel(), rows, bounds, np.zeros(len(bounds), dtype=bool)).reshape(n, 2).T

    return certificate


def _unicycle(certificate: Map, projection_distance: float) -> Map:
    to_commands, to_points = create_si_to_uni_mapping(projection_distance)
    to_velocities = create_uni_to_si_dynamics(projection_distance)

    def barrier_unicycle(dxu: Real, x: Real) -> Real:
        return to_commands(certificate(to_velocities(dxu, x), to_points(x)), x)

    return barrier_unicycle


def _robust(
    drive: DifferentialDrive, disturbance: float, ahead_by: float, gain: float, distance: float, boundary: Real | None
) -> Callable[..., Real]:
    def robust_barriers(dxu: Real, x: Real, obstacles: Real | None = None) -> Real:
        wish = columns("dxu", dxu, 2)
        n = wish.shape[1]
        poses = columns("x", x, 3, n)
        if n == 0:
            return wish
        points, to_points = ahead(poses, ahead_by), _wheels_to_points(poses[2], drive, ahead_by)
        first, second = pairs(n)
        e = (points[:, first] - points[:, second]).T
        closing = np.zeros((len(first), n, 2))
        each = np.arange(len(first))
        closing[each, first] = -2.0 * np.einsum("mk,mkw->mw", e, to_points[first])
        closing[each, second] = 2.0 * np.einsum("mk,mkw->mw", e, to_points[second])
        parts = [_disturbed(closing, (e**2).sum(axis=1), distance, gain, disturbance)]
        if obstacles is not None and np.size(obstacles):
            things = columns("obstacles", obstacles, 2)
            whose, thing = (each.ravel() for each in np.indices((n, things.shape[1])))
            e = (points[:, whose] - things[:, thing]).T
            closing = np.zeros((len(whose), n, 2))
            closing[np.arange(len(whose)), whose] = -2.0 * np.einsum("mk,mkw->mw", e, to_points[whose])
            parts.append(_disturbed(closing, (e**2).sum(axis=1), distance, gain, disturbance))
        every = np.zeros((2 * n, 2 * n))
        for robot in range(n):
            every[2 * robot : 2 * robot + 2, 2 * robot : 2 * robot + 2] = to_points[robot]
        if boundary is not None:
            rows, bounds = boundary_rows(points, boundary, distance, gain)
            parts.append((rows @ every, bounds))
        soft = sum(len(bounds) for _, bounds in parts)
        limits = np.kron(np.eye(2 * n), [[1.0], [-1.0]])
        parts.append((np.asarray(limits), np.full(4 * n, drive.wheel_speed_limit)))
        rows, bounds = (np.concatenate(each) for each in zip(*parts, strict=True))
        wheels = drive.wheel_speeds(wish.T).ravel()
        safe = nearest(wheels, rows, bounds, np.arange(len(bounds)) >= soft, every.T @ every)
        return drive.twist(safe.reshape(n, 2)).T

    return robust_barriers


def _disturbed(closing: Real, squared: Real, distance: float, gain: float, disturbance: float) -> tuple[Real, Real]:
    """Rows (m, 2N) of ``closing`` (m, N, 2) and their bounds, less what disturbances of the wheels can do to them."""
    worst = (closing @ (disturbance * CORNERS)).max(axis=-1).sum(axis=-1)
    return closing.reshape(len(closing), -1), gain * (squared - distance**2) ** 3 - worst


def _wheels_to_points(theta: Real, drive: DifferentialDrive, ahead_by: float) -> Real:
    """(N, 2, 2) the maps from wheel speeds to the velocities of the points ahead of axles at headings theta (N,)."""
    c, s = np.cos(theta), np.sin(theta)
    to_world = np.array([[c, -ahead_by * s], [s, ahead_by * c]]).transpose(2, 0, 1)
    return to_world @ drive.to_twist
