"""What both generations of the Robotarium's class have in common.

What differs from the public simulator: wheels are integrated on exact arcs, or have mass and touch; robots stand at
their initial conditions at once unless the session drives them there; a command that is not finite is refused; nothing
waits; a figure is drawn when something looks at it. Line obstacles are seen by the distance sensors and by nothing
else, as there.
"""

from __future__ import annotations

import random
import sys
import warnings
from abc import ABC, abstractmethod
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robots.model import RobotModel
from robots.rps import constants, starts
from robots.rps.columns import Real, wrapped
from robots.rps.distances import endpoints
from robots.rps.inertial import Readings
from robots.rps.picture import Look, Picture
from robots.rps.session import current
from robots.rps.simulation import WHEELED, Record, Simulation
from robots.rps.version2.misc import generate_initial_poses
from robots.rps.words import sentence
from robots.testbed import Verdict, judge

SEES_NOTHING = -1.0


class Robotarium(ABC):
    """N robots on the testbed's floor, driven step by step.

    Args:
        number_of_robots: 1 to 50; -1 takes as many as ``initial_conditions`` has columns.
        show_figure: whether there is a figure from the start; else there is one as soon as it is asked for.
        sim_in_real_time: accepted; a step never waits.
        initial_conditions: (3, N) poses at which the robots stand; absent or empty, they are drawn.
        use_distance_sensors: whether the distance sensors are on.
        obstacles: lines that they see, (M, 2, 2), metres, see :attr:`lines`.
        plant: in the place of the session's.
        seed: of the poses that are drawn and of the sensors' noise; None for numpy's global generator, as there.

    Raises:
        ValueError: no such plant, no such number of robots, or poses that have another shape or are not finite.
    """

    robot: RobotModel
    look: Look
    drives_in: bool
    """Whether the public simulator of this generation begins at the chargers."""

    alternates = True
    """Whether poses are asked for once before each step; in 2018 they were not."""

    held = True
    """Whether robots on ``pymunk`` hold a pose as there; see :class:`robots.rps.simulation.Simulation`."""

    def __init__(
        self,
        number_of_robots: int,
        show_figure: bool,
        initial_conditions: ArrayLike | None,
        use_distance_sensors: bool,
        obstacles: ArrayLike | None,
        plant: str | None,
        seed: int | None,
        driven: bool,
    ) -> None:
        self._session = current()
        plant = self._session.plant if plant is None else plant
        if plant not in WHEELED:
            raise ValueError(f"plant must be one of {', '.join(WHEELED)}, got {plant!r}")
        self.number_of_robots, given = starts.given_poses(number_of_robots, initial_conditions)
        self.show_figure = show_figure
        self._draws: Any = np.random if seed is None else starts.generator(seed)
        chargers = self._at_chargers() if seed is None and self.drives_in else None
        goals = given if given is not None else self._drawn(seed)
        self.lines = None if obstacles is None else self._as_lines(np.asarray(obstacles, dtype=np.float64))
        self._senses = use_distance_sensors
        self._readings = Readings(self.number_of_robots)
        self._distances = np.full((7, self.number_of_robots), SEES_NOTHING)
        self._leds: Real | None = None
        self._twist = np.zeros((self.number_of_robots, 2))
        self._observed = False
        self._picture: Picture | None = None
        self._simulation = Simulation(
            goals, self.robot, plant, self.held, self._session.measured, self._session.start_draws
        )
        if driven:
            self._begin(goals, chargers)
        if show_figure and "matplotlib.pyplot" in sys.modules:
            self._drawing()
        self._session.begun(self)

    def get_poses(self) -> Real:
        """(3, N) poses, metres and radians, headings in (-pi, pi].

        Raises:
            RuntimeError: called a second time before :meth:`step`.
        """
        if self._observed and self.alternates:
            raise RuntimeError("get_poses() was called twice, expected step() in between")
        self._observed = True
        return self._columns()

    def set_velocities(self, ids: Any, velocities: ArrayLike) -> None:
        """Command v, omega (2, k), m/s and rad/s, to the robots ``ids``; they keep it until the next command.

        ``ids`` is anything that picks columns of an array: numbers, also from the end, a mask, a slice. One command
        (2, 1) is for all that are picked.

        Raises:
            ValueError: ``ids`` names a robot that is not there, ``velocities`` has another shape or is not finite.
        """
        n = self.number_of_robots
        try:
            robots = np.arange(n)[ids if isinstance(ids, slice) else np.asarray(ids)].ravel()
        except IndexError as error:
            raise ValueError(f"ids must be robots in 0..{n - 1}, got {np.asarray(ids).tolist()}") from error
        twist = np.asarray(velocities, dtype=np.float64)
        if twist.shape not in ((2, len(robots)), (2, 1)):
            raise ValueError(f"velocities must have the shape (2, {len(robots)}), got {twist.shape}")
        twist = np.broadcast_to(twist, (2, len(robots)))
        if not np.isfinite(twist).all():
            robot = int(robots[np.flatnonzero(~np.isfinite(twist).all(axis=0))[0]])
            raise ValueError(f"velocities of robot {robot} must be finite")
        self._twist[robots] = self._commanded(twist).T

    def step(self) -> None:
        """Advance all robots by 0.033 s.

        Raises:
            RuntimeError: :meth:`get_poses` was not called since the last step.
        """
        if not self._observed and self.alternates:
            raise RuntimeError("step() was called without get_poses() before it")
        self._observed = False
        self._simulation.step(self._twist)
        self._sense()
        self._session.stepped(self)

    def set_leds(self, ids: Any, leds: ArrayLike) -> None:
        """Light the lamps of the robots ``ids``: red, green, blue (3, k), 0 to 255."""
        if self._leds is None:
            self._leds = np.zeros((3, self.number_of_robots))
        self._leds[:, ids] = leds

    def get_distances(self) -> Real:
        """(7, N) readings of the distance sensors of the last step, metres; -1 for nothing, also if they are off."""
        return self._distances.copy()

    def get_distance_endpoints(self) -> Real:
        """(2, 7, N) where those rays end, metres; NaN for nothing."""
        return endpoints(self._columns(), constants.DISTANCE_SENSORS_ORIENTATION, self._distances)

    def get_accelerations(self) -> Real:
        """(3, N) m/s^2, in the robots' frames."""
        return self._readings.accelerations.copy()

    def get_orientations(self) -> Real:
        """(N,) degrees within [0, 360)."""
        return self._readings.orientations.copy()

    def get_magnetic_fields(self) -> Real:
        """(3, N) microtesla, in the robots' frames."""
        return self._readings.magnetic_fields.copy()

    def get_gyros(self) -> Real:
        """(3, N) rad/s."""
        return self._readings.gyros.copy()

    def get_encoders(self) -> np.ndarray:
        """(2, N) counts of the left and the right wheels since the start, int32."""
        return self._readings.encoders.astype(np.int32)

    def record(self) -> Record:
        """All that happened so far."""
        return self._simulation.recorded()

    def recorded(self) -> tuple[Real, Real, Real]:
        """All that happened: times (T,), s, poses (T, N, 3) and commanded wheel speeds (T, N, 2), rad/s, unclipped."""
        record = self.record()
        return record.t, record.poses, record.wheel_speeds

    @property
    def steps(self) -> int:
        """Steps since the start."""
        return self._simulation.steps

    @property
    def picture(self) -> Picture | None:
        """The figure, if there is one by now."""
        return self._picture

    def debug(self) -> Verdict:
        """Print the testbed's verdict on all steps so far, and return it."""
        t, poses, wheel_speeds = self.recorded()
        verdict = judge(t, poses, wheel_speeds, drive=self.robot.drive)
        print(f"The run takes about {t[-1]:.2f} s on the testbed.")
        if not verdict.violations:
            print("No errors or warnings: the Robotarium would run this script.")
        elif verdict.accepted:
            print("No errors: the Robotarium would run this script.")
        else:
            print("Errors: the Robotarium would reject this script.")
        for violation in verdict.violations:
            print(f"  {sentence(violation)}")
        return verdict

    def call_at_scripts_end(self) -> Verdict:
        """:meth:`debug`, by the name that scripts for ``rps`` 1 call."""
        return self.debug()

    def _columns(self) -> Real:
        x, y, theta = self._simulation.seen.T
        return np.stack([x, y, wrapped(theta)])

    def _drawing(self) -> Picture:
        if self._picture is None:
            self._picture = Picture(
                self._columns, lambda: self._leds, lambda: self._distances, self.lines, self._shown()
            )
        return self._picture

    def _shown(self) -> Look:
        return self.look

    def _begin(self, goals: Real, chargers: Real | None) -> None:
        """Bring the robots to their start as the session says."""
        if self._session.start == "near" and self._session.start_draws is not None:
            self._simulation.place(starts.near(goals, self._session.start_draws))
        elif self._session.start == "driven":
            self._simulation.place(self._at_chargers() if chargers is None else chargers)
            try:
                steps = starts.drive_in(self._simulation, goals, constants.BOUNDARIES, self._sense)
            except starts.StuckError as error:
                self._session.told(str(error))
                raise
            self._session.told(f"the robots came to their start in {steps * constants.TIME_STEP:.0f} s")
            self._simulation.place(self._simulation.poses.copy())
            self._readings = Readings(self.number_of_robots)
        elif self.drives_in:
            self._session.told(
                "the robots stand at their start at once; the testbed drives them there, and so does --drive-to-start"
            )

    def _at_chargers(self) -> Real:
        """(N, 3) poses at the chargers; as many robots as there are no chargers for begin anywhere."""
        low_x, high_x, low_y, high_y = constants.BOUNDARIES
        size = high_x - low_x - constants.ROBOT_DIAMETER, high_y - low_y - constants.ROBOT_DIAMETER
        with suppress(ValueError):
            return np.ascontiguousarray(generate_initial_poses(self.number_of_robots, *size).T)
        return starts.scattered(self.number_of_robots, starts.generator(random.getrandbits(32)))

    def _drawn(self, seed: int | None) -> Real:
        if seed is None:
            with suppress(ValueError):
                return np.ascontiguousarray(self._random_poses().T)
        return starts.scattered(self.number_of_robots, self._draws)

    @abstractmethod
    def _random_poses(self) -> Real:
        """(3, N) poses drawn as this generation draws them.

        Raises:
            ValueError: they do not fit.
        """

    def _as_lines(self, obstacles: Real) -> Real:
        """(M, 2, 2) the ends of each line obstacle."""
        return obstacles

    def _commanded(self, velocities: Real) -> Real:
        """(2, k) what is made of commands as they come in."""
        return velocities

    @abstractmethod
    def _sense(self) -> None:
        """Read all sensors, in the order in which this generation draws their noise."""


def ignored(names: list[str], known: list[str]) -> None:
    """Warn of arguments that mean nothing here, as they mean nothing in ``rps``, which does not say so."""
    for name in names:
        warnings.warn(f"Robotarium: no argument {name!r}, ignored; known: {', '.join(known)}", stacklevel=3)
