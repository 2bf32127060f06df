"""The robust certificate under its name of 2019: see :mod:`robots.rps.version1.barrier_certificates`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robots.rps.columns import Real
from robots.rps.version1.barrier_certificates import create_unicycle_differential_drive_barrier_certificate


def create_robust_barriers(
    max_num_obstacles: int = 100,
    max_num_robots: int = 30,
    d: float = 5.0,
    wheel_vel_limit: float = 12.5,
    base_length: float = 0.105,
    wheel_radius: float = 0.016,
    projection_distance: float = 0.05,
    gamma: float = 150.0,
    safety_radius: float = 0.12,
) -> Callable[[Real, Real, Real], Real]:
    """In wheel speeds, robust against disturbances ``d``, rad/s, of each wheel; ``gamma`` is the gain, 1/(m^4 s).

    Returns:
        A function of wished commands (2, N), poses (3, N) and point obstacles (2, M), which may be empty, that gives
        safe commands (2, N).
    """
    robust = create_unicycle_differential_drive_barrier_certificate(
        max_num_obstacles,
        max_num_robots,
        d,
        wheel_vel_limit,
        base_length,
        wheel_radius,
        projection_distance,
        gamma,
        safety_radius,
    )

    def robust_barriers(dxu: Real, x: Real, obstacles: Real) -> Real:
        return robust(np.asarray(dxu), np.asarray(x), np.asarray(obstacles))

    return robust_barriers
