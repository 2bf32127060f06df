"""Encoders, accelerometer, gyroscope, magnetometer and compass of each robot, with the noise that ``rps`` publishes.

The wheels' encoders count how far the wheels turn, which on ``pymunk`` is further than the robot goes where it slips;
the others measure how it moves. ``rps`` 2.1 compares velocities with themselves, so that its accelerometers read
gravity, turning and noise alone; here they read acceleration too. Draws have the number and order that they have there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robots.model import CONTROL_PERIOD
from robots.rps import constants
from robots.rps.columns import Real

COUNTS_PER_RADIAN = constants.ENCODER_COUNTS_PER_REVOLUTION * constants.MOTOR_GEAR_RATIO / (2.0 * np.pi)
"""Of an encoder, on the motor's side of the gear, per radian of the wheel."""

GRAVITY = -9.81
"""m/s^2 along z, as ``rps`` has it."""


class Readings:
    """What the sensors of N robots read.

    Attributes:
        encoders: (2, N) counts, left and right.
        accelerations: (3, N) m/s^2 at the sensor, in its robot's frame.
        gyros: (3, N) rad/s.
        magnetic_fields: (3, N) microtesla.
        orientations: (N,) degrees within [0, 360).
    """

    def __init__(self, n: int) -> None:
        self.encoders = np.zeros((2, n))
        self.accelerations = np.zeros((3, n))
        self.gyros = np.zeros((3, n))
        self.magnetic_fields = np.zeros((3, n))
        self.orientations = np.zeros(n)
        self._before = np.zeros((n, 2))

    def count(self, turned: Real, draws: Any) -> None:
        """Read the encoders after wheels have turned by (N, 2), radians."""
        counts = COUNTS_PER_RADIAN * turned.T
        noise = constants.ENCODER_NOISE_STD * np.sqrt(np.maximum(np.abs(counts), 1.0))
        self.encoders += np.round(counts + noise * draws.standard_normal(counts.shape))

    def measure(self, motion: Real, theta: Real, draws: Any) -> None:
        """Read all others after a period of twists (N, 2), m/s and rad/s, that ends at headings theta (N,)."""
        noise = draws.standard_normal((10, len(motion)))
        acceleration = (motion - self._before) / CONTROL_PERIOD
        self._before = motion
        zero, omega = np.zeros(len(motion)), motion[:, 1]
        self.accelerations = at_sensor(acceleration, omega) + _spread(constants.ACCELEROMETER_NOISE_STDS) * noise[:3]
        self.gyros = np.array([zero, zero, omega]) + _spread(constants.GYRO_NOISE_STDS) * noise[3:6]
        north = constants.MAGNETOMETER_XY_AVG * np.array([np.cos(theta), -np.sin(theta)])
        field = np.array([*north, np.full(len(motion), constants.MAGNETOMETER_Z_AVG)])
        self.magnetic_fields = field + _spread(constants.MAGNETOMETER_NOISE_STDS) * noise[6:9]
        self.orientations = np.mod(np.degrees(theta) + constants.ORIENTATION_NOISE_STD * noise[9], 360.0)


def at_sensor(acceleration: Real, omega: Real) -> Real:
    """(3, N) m/s^2 that a sensor beside the axle's centre feels.

    Args:
        acceleration: (N, 2) of v and omega, m/s^2 and rad/s^2.
        omega: (N,) rad/s.
    """
    x, y, _ = constants.IMU_ORIENTATION
    forward, turning = acceleration.T
    return np.array(
        [
            forward - turning * y - omega**2 * x,
            turning * x - omega**2 * y,
            np.full(len(omega), GRAVITY),
        ]
    )


def _spread(deviations: Real) -> Real:
    return deviations[:, None]
