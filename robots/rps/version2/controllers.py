"""Controllers that drive robots to positions and poses, as in ``rps`` 2.1."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robots.drive import DifferentialDrive
from robots.rps.columns import Real, along, columns, limited, not_negative, positive, wrapped
from robots.rps.version2.misc import create_at_pose
from robots.rps.version2.transformations import Map, create_si_to_uni_dynamics, create_si_to_uni_mapping

TURN_GAIN = 2.0
"""1/s, of the turn to a goal's heading in place."""

Hybrid = Callable[..., Real | tuple[Real, NDArray[np.float64]]]


def create_si_position_controller(
    x_velocity_gain: float = 0.8, y_velocity_gain: float = 0.8, velocity_magnitude_limit: float = 0.15
) -> Map:
    """Proportional: u = diag(g_x, g_y) (goal - position), shortened to a limit.

    Args:
        x_velocity_gain, y_velocity_gain: 1/s.
        velocity_magnitude_limit: m/s.

    Returns:
        A function of positions (2, N) and goals (2, N), metres, that gives velocities (2, N), m/s.
    """
    positive(x_velocity_gain=x_velocity_gain, y_velocity_gain=y_velocity_gain)
    not_negative(velocity_magnitude_limit=velocity_magnitude_limit)
    gains = np.array([[x_velocity_gain], [y_velocity_gain]])

    def position_controller_si(states: Real, poses: Real) -> Real:
        states = columns("states", states, 2)
        goals = columns("poses", poses, 2, states.shape[1])
        return limited(gains * (goals - states), velocity_magnitude_limit)

    return position_controller_si


def create_uni_position_controller(
    x_velocity_gain: float = 0.8,
    y_velocity_gain: float = 0.8,
    velocity_magnitude_limit: float = 0.15,
    projection_distance: float = 0.03,
) -> Map:
    """:func:`create_si_position_controller` for the point ahead, through the diffeomorphism.

    Args:
        x_velocity_gain, y_velocity_gain: 1/s.
        velocity_magnitude_limit: m/s.
        projection_distance: metres.

    Returns:
        A function of poses (3, N) and goals (2, N), metres, of the points that gives commands (2, N).
    """
    controller = create_si_position_controller(x_velocity_gain, y_velocity_gain, velocity_magnitude_limit)
    si_to_uni, points = create_si_to_uni_mapping(projection_distance)

    def position_controller_uni(states: Real, poses: Real) -> Real:
        return si_to_uni(controller(points(states), poses), states)

    return position_controller_uni


def create_pose_controller_clf(
    approach_angle_gain: float = 1.0,
    desired_angle_gain: float = 2.7,
    rotation_error_gain: float = 1.0,
    wheel_velocity_limit: float = 10.0,
    wheel_radius: float = 0.016,
    base_length: float = 0.105,
) -> Map:
    """A control Lyapunov function of distance and angles (Aicardi et al. 1995), wheels slowed together at their limit.

    With e the distance, theta the bearing of the way to the goal in the goal's frame, alpha the same in the robot's:

        v = g e cos alpha,    omega = k alpha + g cos alpha (sin alpha / alpha) (alpha + h theta).

    Args:
        approach_angle_gain: g, 1/s.
        desired_angle_gain: k, 1/s.
        rotation_error_gain: h.
        wheel_velocity_limit: rad/s.
        wheel_radius, base_length: metres, of the wheels that are slowed.

    Returns:
        A function of poses (3, N) and goals (3, N) that gives commands (2, N).
    """
    drive = DifferentialDrive(wheel_radius, base_length, wheel_velocity_limit)

    def controller_clf(states: Real, poses: Real) -> Real:
        states = columns("states", states, 3)
        goals = columns("poses", poses, 3, states.shape[1])
        command = lyapunov(states, goals, approach_angle_gain, desired_angle_gain, rotation_error_gain)
        return drive.twist(drive.saturate(drive.wheel_speeds(command.T), "scale")).T

    return controller_clf


def create_pose_controller_hybrid(
    linear_velocity_gain: float = 0.8,
    angular_velocity_limit: float = np.pi,
    velocity_magnitude_limit: float = 0.15,
    position_error: float = 0.03,
    position_epsilon: float = 0.01,
    rotation_error: float = 0.05,
) -> Hybrid:
    """Drive to the position, then turn in place; back to driving where the turn has carried the robot off.

    Args:
        linear_velocity_gain, angular_velocity_limit: of :func:`create_si_to_uni_dynamics`.
        velocity_magnitude_limit: m/s, while driving.
        position_error: metres beyond which a robot that turns begins to drive again.
        position_epsilon: metres by which it drives nearer than that.
        rotation_error: radians within which it stands.

    Returns:
        A function of poses (3, N) and goals (3, N) that gives commands (2, N). It remembers who drives and who turns,
        unless it is given that as a third argument (N,), 1 for driving, which it changes and gives back too.
    """
    steer = create_si_to_uni_dynamics(linear_velocity_gain, angular_velocity_limit)
    remembered: list[NDArray[np.float64]] = [np.ones(0)]

    def controller_hybrid(
        states: Real, poses: Real, in_approach_state: NDArray[np.float64] | None = None
    ) -> Real | tuple[Real, NDArray[np.float64]]:
        states = columns("states", states, 3)
        goals = columns("poses", poses, 3, states.shape[1])
        if in_approach_state is None and len(remembered[0]) != states.shape[1]:
            remembered[0] = np.ones(states.shape[1])
        driving = remembered[0] if in_approach_state is None else in_approach_state
        way = goals[:2] - states[:2]
        distance = np.linalg.norm(way, axis=0)
        turn = wrapped(goals[2] - states[2])
        drives = driving.astype(bool) & (distance > position_error - position_epsilon)
        turns = ~drives & (np.abs(turn) > rotation_error)
        driving[turns] = distance[turns] > position_error
        command = np.where(drives, steer(limited(way, velocity_magnitude_limit), states), 0.0)
        command[1, turns] = TURN_GAIN * turn[turns]
        return command if in_approach_state is None else (command, driving)

    return controller_hybrid


def create_pose_parking_controller_clf(
    approach_angle_gain: float = 1.0,
    desired_angle_gain: float = 2.7,
    rotation_error_gain: float = 1.0,
    wheel_velocity_limit: float = 10.0,
    wheel_radius: float = 0.016,
    base_length: float = 0.105,
    position_error: float = 0.05,
    rotation_error: float = 0.2,
) -> Map:
    """:func:`create_pose_controller_clf` that stops robots within ``position_error`` and ``rotation_error``."""
    controller = create_pose_controller_clf(
        approach_angle_gain, desired_angle_gain, rotation_error_gain, wheel_velocity_limit, wheel_radius, base_length
    )
    return _parked(controller, position_error, rotation_error)


def create_pose_parking_controller_hybrid(
    linear_velocity_gain: float = 0.8,
    angular_velocity_limit: float = np.pi,
    velocity_magnitude_limit: float = 0.15,
    position_error: float = 0.05,
    position_epsilon: float = 0.01,
    rotation_error: float = 0.2,
) -> Map:
    """:func:`create_pose_controller_hybrid` that stops robots within ``position_error`` and ``rotation_error``."""
    controller = create_pose_controller_hybrid(
        linear_velocity_gain,
        angular_velocity_limit,
        velocity_magnitude_limit,
        position_error,
        position_epsilon,
        rotation_error,
    )
    return _parked(controller, position_error, rotation_error)


def lyapunov(states: Real, goals: Real, g: float, k: float, h: float) -> Real:
    """(2, N) the commands of :func:`create_pose_controller_clf` without limit, of poses and goals (3, N)."""
    way = along(goals[:2] - states[:2], goals[2])
    distance = np.linalg.norm(way, axis=0)
    theta = np.arctan2(way[1], way[0])
    alpha = wrapped(theta - (states[2] - goals[2]))
    share = np.cos(alpha) * np.sinc(alpha / np.pi)
    return np.array([g * distance * np.cos(alpha), k * alpha + g * share * (alpha + h * theta)])


def _parked(controller: Callable[[Real, Real], Real | tuple[Real, Real]], position: float, rotation: float) -> Map:
    arrived = create_at_pose(position, rotation)

    def controller_parking(states: Real, poses: Real) -> Real:
        command = controller(states, poses)
        return np.where(arrived(states, poses)[1], 0.0, command)

    return controller_parking
