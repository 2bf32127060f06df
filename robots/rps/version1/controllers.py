"""Controllers that drive robots to positions and poses, under the names and with the defaults of ``rps`` 1."""

from __future__ import annotations

import numpy as np

from robots.rps.columns import Real, along, columns, limited, not_negative, wrapped
from robots.rps.version1.transformations import create_si_to_uni_dynamics, single_integrator_to_unicycle2
from robots.rps.version2 import controllers as version2
from robots.rps.version2.controllers import Hybrid, lyapunov
from robots.rps.version2.transformations import Map


def create_si_position_controller(
    x_velocity_gain: float = 1.0, y_velocity_gain: float = 1.0, velocity_magnitude_limit: float = 0.15
) -> Map:
    """As in 2.1, with gains of 1."""
    return version2.create_si_position_controller(x_velocity_gain, y_velocity_gain, velocity_magnitude_limit)


def create_clf_unicycle_position_controller(
    linear_velocity_gain: float = 0.8, angular_velocity_gain: float = 3.0
) -> Map:
    """v = g d cos beta, omega = k d sin beta, d the way to the goal and beta its bearing from the robot.

    Args:
        linear_velocity_gain: g, 1/s.
        angular_velocity_gain: k, 1/(m s).

    Returns:
        A function of poses (3, N) and goals (2, N) that gives commands (2, N), without limit.
    """
    not_negative(linear_velocity_gain=linear_velocity_gain, angular_velocity_gain=angular_velocity_gain)

    def position_uni_clf_controller(states: Real, positions: Real) -> Real:
        states = columns("states", states, 3)
        goals = columns("positions", positions, 2, states.shape[1])
        return along(goals - states[:2], states[2]) * [[linear_velocity_gain], [angular_velocity_gain]]

    return position_uni_clf_controller


def create_clf_unicycle_pose_controller(
    approach_angle_gain: float = 1.0, desired_angle_gain: float = 2.7, rotation_error_gain: float = 1.0
) -> Map:
    """:func:`robots.rps.version2.controllers.create_pose_controller_clf` without limit."""

    def pose_uni_clf_controller(states: Real, poses: Real) -> Real:
        states = columns("states", states, 3)
        goals = columns("poses", poses, 3, states.shape[1])
        return lyapunov(states, goals, approach_angle_gain, desired_angle_gain, rotation_error_gain)

    return pose_uni_clf_controller


def create_hybrid_unicycle_pose_controller(
    linear_velocity_gain: float = 1.0,
    angular_velocity_gain: float = 2.0,
    velocity_magnitude_limit: float = 0.15,
    angular_velocity_limit: float = np.pi,
    position_error: float = 0.05,
    position_epsilon: float = 0.03,
    rotation_error: float = 0.05,
) -> Hybrid:
    """Drive until within ``position_error - position_epsilon``, then turn in place. It has no memory.

    Args:
        linear_velocity_gain, angular_velocity_limit: of :func:`create_si_to_uni_dynamics`.
        angular_velocity_gain: of the turn in place, 1/s.
        velocity_magnitude_limit: m/s, while driving.
        position_error, position_epsilon: metres.
        rotation_error: radians within which a robot stands.

    Returns:
        A function of poses (3, N) and goals (3, N) that gives commands (2, N).
    """
    steer = create_si_to_uni_dynamics(linear_velocity_gain, angular_velocity_limit)

    def pose_uni_hybrid_controller(states: Real, poses: Real, approach_state: Real | None = None) -> Real:
        states = columns("states", states, 3)
        goals = columns("poses", poses, 3, states.shape[1])
        way, turn = goals[:2] - states[:2], wrapped(goals[2] - states[2])
        drives = np.linalg.norm(way, axis=0) > position_error - position_epsilon
        if approach_state is not None and np.size(approach_state):
            drives &= np.ravel(approach_state).astype(bool)
        turns = ~drives & (np.abs(turn) > rotation_error)
        command = np.where(drives, steer(limited(way, velocity_magnitude_limit), states), 0.0)
        command[1, turns] = angular_velocity_gain * turn[turns]
        return command

    return pose_uni_hybrid_controller


def single_integrator_position_controller(
    x: Real, poses: Real, gain: float = 1.0, magnitude_limit: float = 0.08
) -> Real:
    """The position controller, at once, in 2018: (2, N) velocities of positions and goals (2, N), metres."""
    return version2.create_si_position_controller(gain, gain, magnitude_limit)(x, poses)


def unicycle_pose_controller(
    x: Real, poses: Real, magnitude_limit: float = 0.08, position_error: float = 0.01, rotation_error: float = 0.25
) -> Real:
    """The hybrid controller, at once, in 2018: (2, N) commands of poses, goals (3, N); ``rotation_error`` is idle."""
    states = columns("x", x, 3)
    goals = columns("poses", poses, 3, states.shape[1])
    wish = single_integrator_position_controller(states[:2], goals[:2], magnitude_limit=magnitude_limit)
    there = np.linalg.norm(goals[:2] - states[:2], axis=0) <= position_error
    command = np.where(there, 0.0, single_integrator_to_unicycle2(wish, states))
    command[1, there] = wrapped(goals[2] - states[2])[there]
    return command
