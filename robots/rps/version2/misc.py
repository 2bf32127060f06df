"""Random poses, arrival, sizes in a figure, as in ``rps`` 2.1.

Poses are drawn from numpy's global generator, those at the chargers from Python's: scripts that seed them get the poses
that they get there.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots.rps.columns import Real, columns, positive, whole, wrapped

ATTEMPTS = 10_000
"""Places drawn before poses that do not fit are given up."""

CHARGERS = 11
"""On each of the two long sides."""

Arrived = tuple[bool, NDArray[np.bool_]]


def determine_font_size(robotarium_instance: Any, font_height_meters: float) -> float:
    """The size in points of letters as high as ``font_height_meters`` in the robots' figure, by its height."""
    figure = robotarium_instance._fig
    low, high = robotarium_instance.BOUNDARIES[2:]
    return float(figure.get_size_inches()[1] * figure.dpi * font_height_meters / (high - low))


def generate_initial_poses(N: int, width: float = 3.0, height: float = 1.0) -> Real:  # noqa: N803
    """(3, N) poses of robots that come off their chargers, drawn from 11 places on each long side, looking inwards.

    Raises:
        ValueError: there are fewer places than robots.
    """
    places = [
        (x, side * height / 2.0, -side * np.pi / 2.0)
        for x in np.linspace(-width / 2.0, width / 2.0, CHARGERS)
        for side in (-1.0, 1.0)
    ]
    return np.array(random.sample(places, N)).reshape(-1, 3).T


def generate_random_poses(N: int, spacing: float = 0.5, width: float = 3.0, height: float = 1.8) -> Real:  # noqa: N803
    """(3, N) poses on a rectangle about the origin, metres, no two closer than ``spacing``, headings within [-pi, pi).

    Raises:
        ValueError: they do not fit, or no place was found for one.
    """
    places = generate_random_positions(N, spacing, width, height)
    turn = np.random.rand(N)  # noqa: NPY002
    return np.concatenate([places, [turn * 2.0 * np.pi - np.pi]])


def generate_random_positions(N: int, spacing: float = 0.5, width: float = 3.0, height: float = 1.8) -> Real:  # noqa: N803
    """(2, N) positions on a rectangle about the origin, metres, no two closer than ``spacing``.

    Raises:
        ValueError: they do not fit, or no place was found for one.
    """
    return apart(N, spacing, width, height, ATTEMPTS)


def create_at_pose(position_error: float = 0.05, rotation_error: float = 0.2) -> Callable[[Real, Real], Arrived]:
    """A function of poses (3, N) and goals (3, N): whether all have arrived, and who (N,).

    Args:
        position_error: metres.
        rotation_error: radians.
    """

    def check_at_pose(states: Real, poses: Real) -> Arrived:
        states = columns("states", states, 3)
        goals = columns("poses", poses, 3, states.shape[1])
        near = np.linalg.norm(states[:2] - goals[:2], axis=0) <= position_error
        who = near & (np.abs(wrapped(states[2] - goals[2])) <= rotation_error)
        return bool(who.all()), who

    return check_at_pose


def create_at_position(position_error: float = 0.05) -> Callable[[Real, Real], Arrived]:
    """A function of positions or poses (2 or 3, N) and goals (2, N): whether all have arrived, and who (N,).

    Args:
        position_error: metres.
    """

    def check_at_position(states: Real, positions: Real) -> Arrived:
        places = np.asarray(states, dtype=np.float64)[:2]
        goals = columns("positions", positions, 2, places.shape[1])
        who = np.linalg.norm(places - goals, axis=0) <= position_error
        return bool(who.all()), who

    return check_at_position


def rotation_matrix(theta: ArrayLike) -> Real:
    """(3, 3, N) turns about z by angles theta (N,), radians."""
    angle = np.atleast_1d(np.asarray(theta, dtype=np.float64)).ravel()
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros(len(angle)), np.ones(len(angle))
    return np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]])


def unique_filename(file_name: str) -> str:
    """The name with the time of day after it, and the ending .npy."""
    return f"{file_name}_{datetime.now():%Y_%m_%d_%H_%M_%S}.npy"


def apart(n: int, spacing: float, width: float, height: float, attempts: int) -> Real:
    """(2, n) places drawn one by one, those too close to an earlier one dropped.

    Raises:
        ValueError: they cannot fit by their area, or ``attempts`` draws were not enough.
    """
    whole(1, N=n)
    positive(spacing=spacing, width=width, height=height)
    if n > (most := int(width * height / spacing**2)):
        raise ValueError(f"N must be at most {most} for places {spacing} m apart on {width} m by {height} m, got {n}")
    places: list[Real] = []
    for _ in range(attempts):
        if len(places) == n:
            break
        place = (np.random.rand(2) - 0.5) * [width, height]  # noqa: NPY002
        if all(np.linalg.norm(place - other) >= spacing for other in places):
            places.append(place)
    if len(places) < n:
        raise ValueError(f"no place was found for robot {len(places)} of {n} at a spacing of {spacing} m")
    return np.array(places).T
