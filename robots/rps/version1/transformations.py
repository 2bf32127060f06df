"""From single-integrator velocities to unicycle commands and back, as in ``rps`` 1."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robots.rps.columns import Real, along, columns, not_negative, positive
from robots.rps.version2 import transformations as version2
from robots.rps.version2.transformations import Map


def create_si_to_uni_dynamics(linear_velocity_gain: float = 1.0, angular_velocity_limit: float = np.pi) -> Map:
    """Steering as in 2.1, but that the angle is one to the forward part after its gain.

    Args:
        linear_velocity_gain: g, in v = g u_x.
        angular_velocity_limit: the turn at a right angle, rad/s.

    Returns:
        A function of velocities (2, N), m/s, and poses (3, N) that gives commands (2, N).
    """
    positive(linear_velocity_gain=linear_velocity_gain)
    not_negative(angular_velocity_limit=angular_velocity_limit)

    def si_to_uni_dyn(dxi: Real, poses: Real) -> Real:
        dxi = columns("dxi", dxi, 2)
        poses = columns("poses", poses, 3, dxi.shape[1])
        forward, left = along(dxi, poses[2])
        speed = linear_velocity_gain * forward
        return np.array([speed, angular_velocity_limit * np.arctan2(left, speed) / (np.pi / 2.0)])

    return si_to_uni_dyn


def create_si_to_uni_dynamics_with_backwards_motion(
    linear_velocity_gain: float = 1.0, angular_velocity_limit: float = np.pi
) -> Map:
    """In version 1 the same as :func:`create_si_to_uni_dynamics`: robots turn around."""
    return create_si_to_uni_dynamics(linear_velocity_gain, angular_velocity_limit)


def create_si_to_uni_mapping(
    projection_distance: float = 0.05, angular_velocity_limit: float = np.pi
) -> tuple[Map, Callable[[Real], Real]]:
    """The diffeomorphism from the point ahead, with omega cut at a limit.

    Args:
        projection_distance: l, metres.
        angular_velocity_limit: rad/s.

    Returns:
        A function of the point's velocities (2, N), m/s, and poses (3, N) that gives commands (2, N), and one of poses
        that gives the points (2, N).
    """
    not_negative(angular_velocity_limit=angular_velocity_limit)
    exact, uni_to_si_states = version2.create_si_to_uni_mapping(projection_distance)

    def si_to_uni_dyn(dxi: Real, poses: Real) -> Real:
        dxu = exact(dxi, poses)
        dxu[1] = np.clip(dxu[1], -angular_velocity_limit, angular_velocity_limit)
        return dxu

    return si_to_uni_dyn, uni_to_si_states


def create_uni_to_si_dynamics(projection_distance: float = 0.05) -> Map:
    """The diffeomorphism to the point ahead.

    Args:
        projection_distance: metres.

    Returns:
        A function of commands (2, N) and poses (3, N) that gives the point's velocities (2, N), m/s.
    """
    return version2.create_uni_to_si_mapping(projection_distance)[0]


def single_integrator_to_unicycle2(
    dxi: Real, poses: Real, linear_velocity_gain: float = 1.0, angular_velocity_limit: float = np.pi
) -> Real:
    """Steering, at once, in 2018: (2, N) commands of velocities (2, N), m/s, and poses (3, N).

    There the turn is (pi / 2)^2 times that of later versions; the wheels' limits are what remains of it.
    """
    v, omega = create_si_to_uni_dynamics(linear_velocity_gain, angular_velocity_limit)(dxi, poses)
    return np.array([v, (np.pi / 2.0) ** 2 * omega])


def create_single_integrator_to_unicycle(projection_distance: float = 0.05) -> tuple[Map, Callable[[Real], Real]]:
    """The name of :func:`create_si_to_uni_mapping` in 2018, without a limit of omega."""
    return version2.create_si_to_uni_mapping(projection_distance)


def unicycle_to_single_integrator(dxu: Real, poses: Real, projection_distance: float = 0.05) -> Real:
    """The diffeomorphism to the point ahead, at once, in 2018: (2, N) of commands (2, N) and poses (3, N)."""
    return create_uni_to_si_dynamics(projection_distance)(dxu, poses)
