"""The Robotarium's programming interface over our worlds, for scripts that were written for ``rps.robotarium``.

Here alone robots are columns: poses are (3, N) arrays x, y, theta of the axle's centres, metres and radians, commands
are (2, N) arrays v, omega, m/s and rad/s. Robots are counted from 0, as the scripts index them.

What differs from the public simulator (``rps`` 2.1): robots stand at their initial conditions at once; wheels are
integrated on exact arcs, or have mass and touch; a command that is not finite is refused; nothing is drawn and nothing
waits. The simulated sensors, LEDs and line obstacles are not there.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.model import COLLISION_CENTRE, CONTROL_PERIOD, GTERNAL
from robots.nid import NearIdentityDiffeomorphism
from robots.safety.certificate import (
    BARRIER_GAIN,
    BOUNDARY_MARGIN,
    MAGNITUDE_LIMIT,
    SAFETY_RADIUS,
    RobotariumCertificate,
)
from robots.testbed import COLLISION_DISTANCE, Verdict, Violation, judge
from robots.worlds import PLANTS, make_world

Real = NDArray[np.float64]

MOST_ROBOTS = 50
"""Robots that the testbed has."""

_WHEELED = tuple(plant for plant in PLANTS if plant != "single_integrator")
_NID = NearIdentityDiffeomorphism(COLLISION_CENTRE)  # worlds are driven by their projected points
_GRID = (10, 5)  # one place for each of 50 robots: 0.3 m apart along x, 0.4 m along y
_GRID_REACH = (1.35, 0.8)
_JITTER = 0.05


class Robotarium:
    """N robots on the testbed's floor, driven step by step.

    Args:
        number_of_robots: 1 to 50; -1 takes as many as ``initial_conditions`` has columns.
        show_figure: accepted so that scripts run unchanged, without effect: :meth:`recorded` has what there is to see.
        sim_in_real_time: likewise; a step never waits.
        initial_conditions: (3, N) poses at which the robots stand; absent or empty, they are drawn.
        skip_initialization: likewise; the public simulator drives robots to within 0.05 m and 0.2 rad of theirs.
        plant: ``unicycle``, ``saturated`` or ``pymunk``; see :mod:`robots.worlds`.
        seed: of the poses that are drawn.

    Raises:
        ValueError: no such plant, no such number of robots, or poses that have another shape or are not finite.
    """

    TIME_STEP = CONTROL_PERIOD
    MAX_LINEAR_VELOCITY = GTERNAL.drive.speed_limit
    MAX_ANGULAR_VELOCITY = GTERNAL.drive.turn_limit
    MAX_WHEEL_VELOCITY = GTERNAL.drive.wheel_speed_limit
    WHEEL_RADIUS = GTERNAL.drive.wheel_radius
    BASE_LENGTH = GTERNAL.drive.base_length
    ROBOT_DIAMETER = GTERNAL.chassis.width
    COLLISION_OFFSET = COLLISION_CENTRE
    COLLISION_DIAMETER = COLLISION_DISTANCE
    BOUNDARIES = (*ROBOTARIUM_FLOOR.x, *ROBOTARIUM_FLOOR.y)

    def __init__(
        self,
        number_of_robots: int = -1,
        show_figure: bool = False,
        sim_in_real_time: bool = False,
        initial_conditions: ArrayLike | None = None,
        *,
        skip_initialization: bool = False,
        plant: str = "pymunk",
        seed: int = 0,
    ) -> None:
        if plant not in _WHEELED:
            raise ValueError(f"plant must be one of {', '.join(_WHEELED)}, got {plant!r}")
        poses = _initial_poses(number_of_robots, initial_conditions, seed)
        self.number_of_robots = len(poses)
        # The floor's sides are judged and not enforced: a wall would hide that a script drives off the floor.
        floor = Arena(ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y, walls=False)
        self._world = make_world(
            plant, _NID.project(poses), poses[:, 2], nid=_NID, robot=GTERNAL, saturation="clip", arena=floor
        )
        self._twist = np.zeros((self.number_of_robots, 2))
        self._poses = [self._world.poses.copy()]
        self._wheel_speeds = [np.zeros_like(self._twist)]
        self._observed = False

    def get_poses(self) -> Real:
        """(3, N) poses, metres and radians, headings in (-pi, pi].

        Raises:
            RuntimeError: called a second time before :meth:`step`.
        """
        if self._observed:
            raise RuntimeError("get_poses() was called twice, expected step() in between")
        self._observed = True
        x, y, theta = self._world.poses.T
        return np.stack([x, y, np.arctan2(np.sin(theta), np.cos(theta))])

    def set_velocities(self, ids: ArrayLike, velocities: ArrayLike) -> None:
        """Command v, omega (2, k), m/s and rad/s, to the robots ``ids`` (k,); they keep it until the next command.

        Raises:
            ValueError: ``ids`` names a robot outside 0..N-1, ``velocities`` has another shape or is not finite.
        """
        rows, twist = np.atleast_1d(np.asarray(ids)), np.asarray(velocities, dtype=np.float64)
        n = self.number_of_robots
        if rows.ndim != 1 or rows.dtype.kind not in "iu" or not ((rows >= 0) & (rows < n)).all():
            raise ValueError(f"ids must be robots in 0..{n - 1}, got {rows.tolist()}")
        if twist.shape != (2, len(rows)):
            raise ValueError(f"velocities must have the shape (2, {len(rows)}), got {twist.shape}")
        if not np.isfinite(twist).all():
            robot = int(rows[np.flatnonzero(~np.isfinite(twist).all(axis=0))[0]])
            raise ValueError(f"velocities of robot {robot} must be finite")
        self._twist[rows] = twist.T

    def step(self) -> None:
        """Advance all robots by 0.033 s.

        Raises:
            RuntimeError: :meth:`get_poses` was not called since the last step.
        """
        if not self._observed:
            raise RuntimeError("step() was called without get_poses() before it")
        self._observed = False
        velocity = _NID.velocity(self._twist)
        self._world.step(lambda points, headings: velocity, CONTROL_PERIOD)
        self._poses.append(self._world.poses.copy())
        self._wheel_speeds.append(GTERNAL.drive.wheel_speeds(self._twist))

    def recorded(self) -> tuple[Real, Real, Real]:
        """All that happened: times (T,), s, poses (T, N, 3) and commanded wheel speeds (T, N, 2), rad/s, unclipped."""
        t = CONTROL_PERIOD * np.arange(len(self._poses), dtype=np.float64)
        return t, np.stack(self._poses), np.stack(self._wheel_speeds)

    def debug(self) -> Verdict:
        """Print the testbed's verdict on all steps so far, and return it."""
        t, poses, wheel_speeds = self.recorded()
        verdict = judge(t, poses, wheel_speeds)
        print(f"The run takes about {t[-1]:.2f} s on the testbed.")
        if not verdict.violations:
            print("No errors or warnings: the Robotarium would run this script.")
        elif verdict.accepted:
            print("No errors: the Robotarium would run this script.")
        else:
            print("Errors: the Robotarium would reject this script.")
        for violation in verdict.violations:
            print(f"  {_sentence(violation)}")
        return verdict

    def call_at_scripts_end(self) -> Verdict:
        """:meth:`debug`, by the name that scripts for ``rps`` 1 call."""
        return self.debug()


def create_si_barrier_certificate_with_boundary(
    safety_radius: float = SAFETY_RADIUS,
    barrier_gain: float = BARRIER_GAIN,
    magnitude_limit: float = MAGNITUDE_LIMIT,
    boundary_points: ArrayLike | None = None,
) -> Callable[[Real, Real], Real]:
    """The certificate of :mod:`robots.safety.certificate` as scripts call it.

    Args:
        safety_radius: metres between two robots.
        barrier_gain: 1/(m^4 s).
        magnitude_limit: m/s that no robot exceeds.
        boundary_points: x low, x high, y low, y high, metres; 0.1 m beyond the floor where absent.

    Returns:
        A function of wished velocities (2, N), m/s, and positions (2, N), metres, or poses (3, N), that gives the
        nearest safe velocities (2, N).
    """
    boundary, margin = ROBOTARIUM_FLOOR, BOUNDARY_MARGIN
    if boundary_points is not None:
        low_x, high_x, low_y, high_y = np.asarray(boundary_points, dtype=np.float64).tolist()
        boundary, margin = Arena((low_x, high_x), (low_y, high_y)), 0.0

    def certificate(velocities: Real, positions: Real) -> Real:
        wish = np.ascontiguousarray(velocities.T)
        world_frame = np.zeros_like(wish)
        world_frame[:, 0] = 1.0
        safe = RobotariumCertificate(wish.shape[:1], boundary, safety_radius, barrier_gain, magnitude_limit, margin)
        points = np.ascontiguousarray(positions[:2].T)
        return safe.filter(points, world_frame, wish, np.zeros_like(wish), CONTROL_PERIOD).T

    return certificate


def _initial_poses(number: int, given: ArrayLike | None, seed: int) -> Real:
    """(N, 3) the poses at which the robots stand."""
    columns = np.empty(0) if given is None else np.asarray(given, dtype=np.float64)
    if columns.size and (columns.ndim != 2 or len(columns) != 3):
        raise ValueError(f"initial_conditions must have the shape (3, N), got {columns.shape}")
    if not np.isfinite(columns).all():
        raise ValueError("initial_conditions must be finite")
    n = columns.shape[1] if columns.size and number == -1 else number
    if not 1 <= n <= MOST_ROBOTS:
        raise ValueError(f"number_of_robots must be 1 to {MOST_ROBOTS}, got {n}")
    if not columns.size:
        return _scattered(n, np.random.default_rng(seed))
    if columns.shape[1] != n:
        raise ValueError(f"initial_conditions must have the shape (3, {n}), got {columns.shape}")
    return columns.T


def _scattered(n: int, rng: np.random.Generator) -> Real:
    """(n, 3) random poses, no two collision centres closer than 0.15 m."""
    column, row = np.divmod(rng.permutation(_GRID[0] * _GRID[1])[:n], _GRID[1])
    places = np.stack([column / (_GRID[0] - 1), row / (_GRID[1] - 1)], axis=1)
    points = (2.0 * places - 1.0) * _GRID_REACH + rng.uniform(-_JITTER, _JITTER, (n, 2))
    return np.concatenate([points, rng.uniform(-np.pi, np.pi, (n, 1))], axis=1)


def _sentence(violation: Violation) -> str:
    who = " and ".join(str(robot) for robot in violation.robots)
    what = {
        "floor": f"robot {who} leaves the floor by {violation.value:.3f} m",
        "collision": f"robots {who} come within {COLLISION_DISTANCE} m: {violation.value:.3f} m",
        "obstacle": f"robot {who} comes within {violation.value:.3f} m of an obstacle",
        "actuator": f"robot {who} is commanded {violation.value:.2f} rad/s at a wheel, which is clipped",
    }[violation.kind]
    severity = "WARNING" if violation.kind == "actuator" else "ERROR"
    x, y = violation.place
    return f"{severity}: {what}, first at {violation.time:.2f} s near ({x:.2f}, {y:.2f}) m; {violation.steps} steps"
