"""Random poses, arrival, sizes in a figure, under the names of ``rps`` 1."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robots.rps.columns import Real
from robots.rps.distances import endpoints
from robots.rps.version2 import misc as version2

ATTEMPTS = 200
"""Places drawn before poses that do not fit are given up."""


def generate_initial_conditions(
    N: int,  # noqa: N803
    spacing: float = 0.3,
    width: float = 3.0,
    height: float = 1.8,
) -> Real:
    """(3, N) poses on a rectangle about the origin, metres, no two closer than ``spacing``, headings within [-pi, pi).

    Raises:
        ValueError: they do not fit, or no place was found for one.
    """
    places = version2.apart(N, spacing, width, height, ATTEMPTS)
    return np.concatenate([places, [np.random.uniform(-np.pi, np.pi, N)]])  # noqa: NPY002


def at_pose(
    states: Real, poses: Real, position_error: float = 0.05, rotation_error: float = 0.2
) -> tuple[np.ndarray, ...]:
    """Who has arrived, as ``np.nonzero`` gives it: poses (3, N), goals (3, N), metres and radians."""
    return np.nonzero(version2.create_at_pose(position_error, rotation_error)(states, poses)[1])


def at_position(states: Real, points: Real, position_error: float = 0.02) -> tuple[np.ndarray, ...]:
    """Who has arrived, as ``np.nonzero`` gives it: positions or poses (2 or 3, N), goals (2, N), metres."""
    return np.nonzero(version2.create_at_position(position_error)(states, points)[1])


def rotation_matrix(theta: ArrayLike) -> Real:
    """(N, 3, 3) turns about z by angles theta (N,), radians."""
    return np.moveaxis(version2.rotation_matrix(theta), -1, 0)


def determine_marker_size(robotarium_instance: Any, marker_size_meters: float) -> float:
    """The area in square points of a marker as wide as ``marker_size_meters`` in the robots' figure."""
    width, height = robotarium_instance.boundaries[2:]
    pixels = robotarium_instance.axes.transData.transform(np.array([[width], [height]]))
    return float((pixels[0, 0] * marker_size_meters / width) ** 2)


def determine_font_size(robotarium_instance: Any, font_height_meters: float) -> float:
    """The size in points of letters as high as ``font_height_meters`` in the robots' figure."""
    low, high = robotarium_instance.axes.get_window_extent().get_points()[:, 1]
    return float((high - low) / robotarium_instance.boundaries[2] * font_height_meters)


def calculate_global_distance_points(robotarium_instance: Any, poses: Real, distances: Real) -> Real:
    """(2, 7, N) what distance sensors of robots at poses (3, N) see at distances (7, N), metres; NaN: nothing."""
    return endpoints(poses, robotarium_instance.distance_sensors_orientation, distances)
