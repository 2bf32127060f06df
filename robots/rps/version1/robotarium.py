"""The class ``Robotarium`` of ``rps`` 1, with the names of 2018 and 2019."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from robots.model import GTERNAL
from robots.rps import constants
from robots.rps.columns import Real
from robots.rps.distances import against_discs, against_lines
from robots.rps.picture import Look
from robots.rps.robotarium import SEES_NOTHING, ignored
from robots.rps.robotarium import Robotarium as Common
from robots.rps.version1.misc import generate_initial_conditions

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BASE_LENGTH = 0.105
"""Metres, as it was until 2.0."""

SPACING, WIDTH, HEIGHT = 0.2, 2.5, 1.5
"""Metres, of starts that are drawn."""

KNOWN = [
    "number_of_robots",
    "show_figure",
    "sim_in_real_time",
    "initial_conditions",
    "use_distance_sensors",
    "obstacles",
    "number_of_agents",
    "save_data",
    "update_time",
]
"""Arguments."""

LONGEST_ERROR = 3.0
"""Standard deviations at which a distance sensor's noise ends."""


class Robotarium(Common):
    """See :class:`robots.rps.robotarium.Robotarium`; obstacles are lines from [k, :, 0] to [k, :, 1].

    Args:
        number_of_agents: ``number_of_robots`` in 2018.
        save_data, update_time: of 2018, without effect.
        others: ignored with a warning.
    """

    robot = replace(GTERNAL, drive=replace(GTERNAL.drive, base_length=BASE_LENGTH))
    look = Look(margin=0.1, inches=2.0)
    drives_in = False

    time_step = constants.TIME_STEP
    boundaries = (-1.6, -1.0, 3.2, 2.0)
    """x, y of the lower left corner, width and height, metres."""
    boundary = boundaries
    robot_diameter = constants.ROBOT_DIAMETER
    robot_radius = robot_size = robot_diameter / 2.0
    robot_length, robot_width = 0.095, 0.09
    wheel_radius = constants.WHEEL_RADIUS
    base_length = BASE_LENGTH
    max_linear_velocity = constants.MAX_LINEAR_VELOCITY
    max_angular_velocity = constants.MAX_ANGULAR_VELOCITY
    max_wheel_velocity = constants.MAX_WHEEL_VELOCITY
    collision_offset, collision_diameter = constants.COLLISION_OFFSET, constants.COLLISION_DIAMETER
    encoder_counts_per_revolution = float(constants.ENCODER_COUNTS_PER_REVOLUTION)
    motor_gear_ratio, encoder_noise_std = constants.MOTOR_GEAR_RATIO, constants.ENCODER_NOISE_STD
    distance_sensor_range, distance_sensor_error = constants.DISTANCE_SENSOR_RANGE, constants.DISTANCE_SENSOR_ERROR
    distance_sensor_dropout_prob = constants.DISTANCE_SENSOR_DROPOUT_PROB
    distance_sensor_outlier_prob = constants.DISTANCE_SENSOR_OUTLIER_PROB
    distance_sensors_orientation = constants.DISTANCE_SENSORS_ORIENTATION
    imu_orientation = constants.IMU_ORIENTATION[:, None]
    gyro_noise_stds, accelerometer_noise_stds = constants.GYRO_NOISE_STDS, constants.ACCELEROMETER_NOISE_STDS
    magnetometer_noise_stds = constants.MAGNETOMETER_NOISE_STDS
    magnetometer_z_avg, magnetometer_xy_avg = constants.MAGNETOMETER_Z_AVG, constants.MAGNETOMETER_XY_AVG
    orientation_noise_std = constants.ORIENTATION_NOISE_STD

    def __init__(
        self,
        number_of_robots: int = -1,
        show_figure: bool = True,
        sim_in_real_time: bool = True,
        initial_conditions: ArrayLike | None = None,
        use_distance_sensors: bool = False,
        obstacles: ArrayLike | None = None,
        *,
        number_of_agents: int | None = None,
        save_data: bool = False,
        update_time: float = constants.TIME_STEP,
        plant: str | None = None,
        seed: int | None = None,
        **others: Any,
    ) -> None:
        ignored(sorted(others), KNOWN)
        self.alternates = number_of_agents is None
        self.initial_conditions = initial_conditions
        self.obstacles = obstacles
        super().__init__(
            number_of_robots if number_of_agents is None else number_of_agents,
            show_figure,
            initial_conditions,
            use_distance_sensors,
            obstacles,
            plant,
            seed,
            driven=True,
        )

    @property
    def number_of_agents(self) -> int:
        """``number_of_robots`` in 2018."""
        return self.number_of_robots

    @property
    def poses(self) -> Real:
        """(3, N) poses, at any time."""
        return self._columns()

    @property
    def velocities(self) -> Real:
        """(2, N) commands."""
        return self._twist.T.copy()

    @property
    def axes(self) -> Axes:
        """What the arena is drawn in."""
        return self._drawing().axes

    @property
    def figure(self) -> Figure:
        """What those are in."""
        return self._drawing().figure

    def transform_distance_readings(self) -> Real:
        """(2, 7N) where the rays of the distance sensors end, metres, robot by robot; NaN for nothing."""
        return self.get_distance_endpoints().transpose(0, 2, 1).reshape(2, -1)

    def _random_poses(self) -> Real:
        return generate_initial_conditions(self.number_of_robots, SPACING, WIDTH, HEIGHT)

    def _as_lines(self, obstacles: Real) -> Real:
        return obstacles.swapaxes(1, 2)

    def _commanded(self, velocities: Real) -> Real:
        limits = np.array([[self.max_linear_velocity], [self.max_angular_velocity]])
        return np.clip(velocities, -limits, limits)

    def _sense(self) -> None:
        simulation = self._simulation
        self._readings.count(simulation.turned, self._draws)
        if self._senses:
            self._distances = self._distances_now()
        self._readings.measure(simulation.motion, simulation.poses[:, 2], self._draws)

    def _distances_now(self) -> Real:
        """(7, N) readings, by one draw for each sensor that says what becomes of it."""
        sensors, reach = self.distance_sensors_orientation, self.distance_sensor_range
        poses = self._simulation.poses.T
        true = np.minimum(
            against_lines(poses, sensors, self.lines, reach), against_discs(poses, sensors, self.robot_radius, reach)
        )
        readings = np.full(true.shape, SEES_NOTHING)
        lost, strange = self.distance_sensor_dropout_prob, self.distance_sensor_outlier_prob
        for robot in range(self.number_of_robots):
            seen, fate = true[:, robot] < reach, self._draws.rand(len(true))
            good = seen & (fate >= lost + strange)
            spread = self.distance_sensor_error * true[good, robot]
            noise = np.clip(spread * self._draws.randn(good.sum()), -LONGEST_ERROR * spread, LONGEST_ERROR * spread)
            phantoms = reach * self._draws.rand(len(true))
            readings[good, robot] = np.clip(true[good, robot] + noise, 0.0, reach)
            odd = seen & (fate >= lost) & (fate < lost + strange)
            readings[odd, robot] = phantoms[odd]
        return readings


RobotariumABC = Robotarium
"""The name of its base there."""
