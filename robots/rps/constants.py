"""The public simulator's own constants (``rps`` 2.1), by the names that scripts read them by."""

from __future__ import annotations

import numpy as np

from robots.arena import ROBOTARIUM_FLOOR
from robots.model import COLLISION_CENTRE, CONTROL_PERIOD, GTERNAL
from robots.testbed import COLLISION_DISTANCE

TIME_STEP = CONTROL_PERIOD
MAX_LINEAR_VELOCITY = GTERNAL.drive.speed_limit
MAX_ANGULAR_VELOCITY = GTERNAL.drive.turn_limit
MAX_WHEEL_VELOCITY = GTERNAL.drive.wheel_speed_limit
WHEEL_RADIUS = GTERNAL.drive.wheel_radius
BASE_LENGTH = GTERNAL.drive.base_length
ROBOT_DIAMETER = GTERNAL.chassis.width
COLLISION_OFFSET = COLLISION_CENTRE
COLLISION_DIAMETER = COLLISION_DISTANCE
BOUNDARIES = np.array([*ROBOTARIUM_FLOOR.x, *ROBOTARIUM_FLOOR.y])
CENTER_OFFSET = 0.01
"""Metres ahead of the axle, of the disc that a distance sensor sees of another robot."""

DISTANCE_SENSOR_ERROR = 0.03
DISTANCE_SENSOR_DROPOUT_PROB = 0.035
DISTANCE_SENSOR_OUTLIER_PROB = 0.014
DISTANCE_SENSOR_RANGE = 1.2
DISTANCE_SENSORS_ORIENTATION = np.array(
    [
        [-0.04, 0.0, 0.04, 0.05, 0.04, 0.0, -0.04],
        [0.04, 0.06, 0.05, 0.0, -0.05, -0.06, -0.04],
        np.pi * np.array([1.0, 0.5, 0.25, 0.0, -0.25, -0.5, -1.0]),
    ]
)
"""(3, 7) x, y, theta of each sensor in the robot's frame, metres and radians."""

ENCODER_COUNTS_PER_REVOLUTION = 28
MOTOR_GEAR_RATIO = 100.37
ENCODER_NOISE_STD = 0.25
"""Counts, of one count; it grows with their square root."""

IMU_ORIENTATION = np.array([0.0594 - 0.00319, 0.0344628 - 0.0475, 0.0])
"""x, y, theta of the inertial sensor in the robot's frame, metres and radians."""

ACCELEROMETER_NOISE_STDS = np.array([0.012929, 0.012127, 0.052979])
GYRO_NOISE_STDS = np.array([0.001663, 0.001216, 0.002372])
MAGNETOMETER_NOISE_STDS = np.array([3.275843, 2.365798, 5.232685])
MAGNETOMETER_Z_AVG = -39.8594
MAGNETOMETER_XY_AVG = 6.0712
ORIENTATION_NOISE_STD = 0.310830
"""Degrees."""
