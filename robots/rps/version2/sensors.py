"""Readings of the distance sensors, as in ``rps`` 2.1: geometry, then noise, drop-outs and phantoms.

A reading of what is within reach is lost with one probability, else anything with another, else off by a normal error
in proportion to the distance. Draws come from numpy's global generator, in the order robot by robot, sensor by sensor.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robots.rps.columns import Real
from robots.rps.distances import against_discs, against_lines

NOTHING = -1.0
"""What a sensor reads that sees nothing."""


def simulate_distance_sensors(
    poses: Real,
    obstacles: Real | None,
    distance_sensors_orientation: Real,
    robot_diameter: float,
    robot_center_offset: float,
    distance_sensor_range: float,
    distance_sensor_error: float,
    distance_sensor_dropout_prob: float,
    distance_sensor_outlier_prob: float,
) -> Real:
    """(S, N) readings among line obstacles and the other robots, metres; -1 for nothing.

    Args:
        poses: (3, N).
        obstacles: (M, 2, 2) lines from [k, 0] to [k, 1], metres, or None.
        distance_sensors_orientation: (3, S) x, y, theta of each sensor in the robot's frame.
        robot_diameter: of the disc that a robot is to the others, metres.
        robot_center_offset: metres by which discs and sensors lie ahead of the axles.
        distance_sensor_range: metres.
        distance_sensor_error: standard deviation as a share of the distance.
        distance_sensor_dropout_prob, distance_sensor_outlier_prob: of a reading within reach.
    """
    true = seen(
        poses, obstacles, distance_sensors_orientation, robot_diameter, robot_center_offset, distance_sensor_range
    )
    odds = distance_sensor_dropout_prob, distance_sensor_outlier_prob
    return read(true, distance_sensor_range, distance_sensor_error, *odds, np.random)


def simulate_distance_sensors_without_robots(
    poses: Real,
    obstacles: Real | None,
    distance_sensors_orientation: Real,
    distance_sensor_range: float,
    distance_sensor_error: float,
    distance_sensor_dropout_prob: float,
    distance_sensor_outlier_prob: float,
) -> Real:
    """:func:`simulate_distance_sensors` among line obstacles alone, sensors in the axles' frames."""
    true = against_lines(
        np.asarray(poses, dtype=np.float64), distance_sensors_orientation, obstacles, distance_sensor_range
    )
    odds = distance_sensor_dropout_prob, distance_sensor_outlier_prob
    return read(true, distance_sensor_range, distance_sensor_error, *odds, np.random)


def seen(
    poses: Real, obstacles: Real | None, sensors: Real, robot_diameter: float, robot_center_offset: float, reach: float
) -> Real:
    """(S, N) true distances, metres, or ``reach``; arguments as of :func:`simulate_distance_sensors`."""
    moved = np.array(poses, dtype=np.float64)
    moved[:2] += robot_center_offset * np.array([np.cos(moved[2]), np.sin(moved[2])])
    return np.minimum(
        against_lines(moved, sensors, obstacles, reach), against_discs(moved, sensors, robot_diameter / 2.0, reach)
    )


def read(true: Real, reach: float, error: float, dropout: float, outlier: float, draws: Any) -> Real:
    """(S, N) readings of true distances (S, N); ``draws`` is a generator of numpy's old kind, or ``np.random``."""
    readings = np.full(true.shape, NOTHING)
    for robot, sensor in np.argwhere(reach > true.T):
        distance = true[sensor, robot]
        if draws.rand() < dropout:
            continue
        if draws.rand() < outlier:
            readings[sensor, robot] = draws.uniform(0.0, reach)
        else:
            readings[sensor, robot] = np.clip(distance + error * distance * draws.randn(), 0.0, reach)
    return readings
