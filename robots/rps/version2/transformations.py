"""From single-integrator velocities to unicycle commands and back, as in ``rps`` 2.1.

Two ways: steering, v along the heading and omega by the angle between velocity and heading; and the near-identity
diffeomorphism of :mod:`robots.nid`, exact for a point ahead of the axle.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robots.rps.columns import Real, across, ahead, along, columns, not_negative, positive

Map = Callable[[Real, Real], Real]


def create_si_to_uni_dynamics(linear_velocity_gain: float = 1.0, angular_velocity_limit: float = np.pi) -> Map:
    """Steering: v = g u_x, omega = w (angle of u in the body frame) / (pi / 2); robots turn in place towards u.

    Args:
        linear_velocity_gain: g.
        angular_velocity_limit: w, the turn at a right angle, rad/s.

    Returns:
        A function of velocities (2, N), m/s, and poses (3, N) that gives commands (2, N).
    """
    positive(linear_velocity_gain=linear_velocity_gain)
    not_negative(angular_velocity_limit=angular_velocity_limit)

    def si_to_uni(dxi: Real, states: Real) -> Real:
        dxi = columns("dxi", dxi, 2)
        states = columns("states", states, 3, dxi.shape[1])
        forward, left = along(dxi, states[2])
        turn = angular_velocity_limit * np.arctan2(left, forward) / (np.pi / 2.0)
        return np.array([linear_velocity_gain * forward, turn])

    return si_to_uni


def create_si_to_uni_dynamics_with_backwards_motion(
    linear_velocity_gain: float = 1.0, angular_velocity_limit: float = np.pi
) -> Map:
    """Steering by the nearer end: robots drive backwards where u points behind them.

    Args:
        linear_velocity_gain: g, also of the forward part whose angle steers.
        angular_velocity_limit: the turn at a right angle, rad/s.

    Returns:
        A function of velocities (2, N), m/s, and poses (3, N) that gives commands (2, N).
    """
    positive(linear_velocity_gain=linear_velocity_gain)
    not_negative(angular_velocity_limit=angular_velocity_limit)

    def si_to_uni(dxi: Real, states: Real) -> Real:
        dxi = columns("dxi", dxi, 2)
        states = columns("states", states, 3, dxi.shape[1])
        forward, left = along(dxi, states[2])
        end = np.where((forward > 0.0) | ((forward == 0.0) & (left == 0.0)), 1.0, -1.0)
        speed = linear_velocity_gain * end * forward
        turn = angular_velocity_limit * np.arctan2(end * left, speed + 0.0) / (np.pi / 2.0)
        return np.array([end * speed, turn])

    return si_to_uni


def create_si_to_uni_mapping(projection_distance: float = 0.05) -> tuple[Map, Callable[[Real], Real]]:
    """The diffeomorphism from the point ahead: v = u_x, omega = u_y / l, without a limit.

    Args:
        projection_distance: l, metres.

    Returns:
        A function of the point's velocities (2, N), m/s, and poses (3, N) that gives commands (2, N), and one of poses
        that gives the points (2, N).
    """
    positive(projection_distance=projection_distance)

    def si_to_uni(dxi: Real, states: Real) -> Real:
        dxi = columns("dxi", dxi, 2)
        states = columns("states", states, 3, dxi.shape[1])
        forward, left = along(dxi, states[2])
        return np.array([forward, left / projection_distance])

    def uni_to_si(states: Real) -> Real:
        return ahead(columns("states", states, 3), projection_distance)

    return si_to_uni, uni_to_si


def create_uni_to_si_mapping(projection_distance: float = 0.05) -> tuple[Map, Map]:
    """The diffeomorphism to the point ahead.

    Args:
        projection_distance: l, metres.

    Returns:
        A function of commands (2, N) and poses (3, N) that gives the point's velocities (2, N), m/s, and one of poses
        and points (2, N) that gives the places of the axles (2, N).
    """
    positive(projection_distance=projection_distance)

    def uni_to_si(dxu: Real, states: Real) -> Real:
        dxu = columns("dxu", dxu, 2)
        states = columns("states", states, 3, dxu.shape[1])
        return across(dxu * [[1.0], [projection_distance]], states[2])

    def si_to_uni(uni_states: Real, si_states: Real) -> Real:
        uni_states = columns("uni_states", uni_states, 3)
        si_states = columns("si_states", si_states, 2, uni_states.shape[1])
        theta = uni_states[2]
        return si_states - projection_distance * np.array([np.cos(theta), np.sin(theta)])

    return uni_to_si, si_to_uni
