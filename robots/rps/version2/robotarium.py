"""The class ``Robotarium`` of ``rps`` 2.1."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from robots.model import GTERNAL
from robots.rps import constants
from robots.rps.columns import Real
from robots.rps.picture import Look
from robots.rps.robotarium import Robotarium as Common
from robots.rps.robotarium import ignored
from robots.rps.version2.misc import generate_random_poses
from robots.rps.version2.sensors import read, seen

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

SPACING, WIDTH, HEIGHT = 0.5, 2.75, 1.75
"""Metres, of starts that are drawn."""

KNOWN = [
    "number_of_robots",
    "show_figure",
    "sim_in_real_time",
    "initial_conditions",
    "skip_initialization",
    "use_distance_sensors",
    "obstacles",
    "show_arena_boundaries",
    "show_robot_patches",
    "show_distance_endpoints",
    "show_distance_rays",
    "show_obstacles",
]
"""Arguments."""


class Robotarium(Common):
    """See :class:`robots.rps.robotarium.Robotarium`; obstacles are lines from [k, 0] to [k, 1].

    Args:
        skip_initialization: stand at the initial conditions also where the session drives robots there.
        show_arena_boundaries, show_robot_patches, show_distance_endpoints, show_distance_rays, show_obstacles: in the
            figure.
        others: ignored with a warning.
    """

    TIME_STEP = constants.TIME_STEP
    MAX_LINEAR_VELOCITY = constants.MAX_LINEAR_VELOCITY
    MAX_ANGULAR_VELOCITY = constants.MAX_ANGULAR_VELOCITY
    MAX_WHEEL_VELOCITY = constants.MAX_WHEEL_VELOCITY
    WHEEL_RADIUS = constants.WHEEL_RADIUS
    BASE_LENGTH = constants.BASE_LENGTH
    ROBOT_DIAMETER = constants.ROBOT_DIAMETER
    COLLISION_OFFSET = constants.COLLISION_OFFSET
    COLLISION_DIAMETER = constants.COLLISION_DIAMETER
    BOUNDARIES = constants.BOUNDARIES
    CENTER_OFFSET = constants.CENTER_OFFSET
    DISTANCE_SENSOR_ERROR = constants.DISTANCE_SENSOR_ERROR
    DISTANCE_SENSOR_DROPOUT_PROB = constants.DISTANCE_SENSOR_DROPOUT_PROB
    DISTANCE_SENSOR_OUTLIER_PROB = constants.DISTANCE_SENSOR_OUTLIER_PROB
    DISTANCE_SENSOR_RANGE = constants.DISTANCE_SENSOR_RANGE
    DISTANCE_SENSORS_ORIENTATION = constants.DISTANCE_SENSORS_ORIENTATION
    ENCODER_COUNTS_PER_REVOLUTION = constants.ENCODER_COUNTS_PER_REVOLUTION
    MOTOR_GEAR_RATIO = constants.MOTOR_GEAR_RATIO
    ENCODER_NOISE_STD = constants.ENCODER_NOISE_STD
    IMU_ORIENTATION = constants.IMU_ORIENTATION
    ACCELEROMETER_NOISE_STDS = constants.ACCELEROMETER_NOISE_STDS
    GYRO_NOISE_STDS = constants.GYRO_NOISE_STDS
    MAGNETOMETER_NOISE_STDS = constants.MAGNETOMETER_NOISE_STDS
    MAGNETOMETER_Z_AVG = constants.MAGNETOMETER_Z_AVG
    MAGNETOMETER_XY_AVG = constants.MAGNETOMETER_XY_AVG
    ORIENTATION_NOISE_STD = constants.ORIENTATION_NOISE_STD

    robot = GTERNAL
    look = Look()
    drives_in = True

    def __init__(
        self,
        number_of_robots: int = -1,
        show_figure: bool = False,
        sim_in_real_time: bool = True,
        initial_conditions: ArrayLike | None = None,
        use_distance_sensors: bool = False,
        obstacles: ArrayLike | None = None,
        *,
        skip_initialization: bool = False,
        show_arena_boundaries: bool = True,
        show_robot_patches: bool = True,
        show_distance_endpoints: bool = True,
        show_distance_rays: bool = False,
        show_obstacles: bool = True,
        plant: str | None = None,
        seed: int | None = None,
        **others: Any,
    ) -> None:
        ignored(sorted(others), KNOWN)
        self.show_arena_boundaries, self.show_robot_patches = show_arena_boundaries, show_robot_patches
        self.show_distance_endpoints, self.show_distance_rays = show_distance_endpoints, show_distance_rays
        self.show_obstacles = show_obstacles
        self.obstacles = obstacles
        super().__init__(
            number_of_robots,
            show_figure,
            initial_conditions,
            use_distance_sensors,
            obstacles,
            plant,
            seed,
            driven=not skip_initialization,
        )

    @property
    def _axes_handle(self) -> Axes:
        return self._drawing().axes

    @property
    def _fig(self) -> Figure:
        return self._drawing().figure

    @property
    def _poses(self) -> Real:
        return self._columns()

    @property
    def _velocities(self) -> Real:
        return self._twist.T.copy()

    def robot_colormap(self) -> Colormap:
        """The colours that tell robots apart."""
        import matplotlib

        return matplotlib.colormaps["tab20"]

    def initialize(self, initial_conditions: ArrayLike) -> None:
        """Stand at poses (3, N) anew, with no past."""
        self._simulation.place(np.ascontiguousarray(np.asarray(initial_conditions, dtype=np.float64).T))

    def _shown(self) -> Look:
        return replace(
            self.look,
            arena=self.show_arena_boundaries,
            robots=self.show_robot_patches,
            endpoints=self._senses and self.show_distance_endpoints,
            rays=self._senses and self.show_distance_rays,
            obstacles=self.show_obstacles,
        )

    def _random_poses(self) -> Real:
        return generate_random_poses(self.number_of_robots, SPACING, WIDTH, HEIGHT)

    def _sense(self) -> None:
        simulation = self._simulation
        if self._senses:
            reach, sensors = self.DISTANCE_SENSOR_RANGE, self.DISTANCE_SENSORS_ORIENTATION
            true = seen(simulation.poses.T, self.lines, sensors, self.ROBOT_DIAMETER, self.CENTER_OFFSET, reach)
            odds = self.DISTANCE_SENSOR_DROPOUT_PROB, self.DISTANCE_SENSOR_OUTLIER_PROB
            self._distances = read(true, reach, self.DISTANCE_SENSOR_ERROR, *odds, self._draws)
        self._readings.count(simulation.turned, self._draws)
        self._readings.measure(simulation.motion, simulation.poses[:, 2], self._draws)


ARobotarium = Robotarium
"""The name of its base there."""
