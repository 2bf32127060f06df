"""The robots themselves: a world driven by twists of the axles, and all that happened in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.measured import MeasuredModel
from robots.measured.world import Measured
from robots.model import COLLISION_CENTRE, CONTROL_PERIOD, RobotModel
from robots.nid import NearIdentityDiffeomorphism
from robots.worlds import PLANTS, make_world
from robots.worlds.contact import SUBSTEPS, Contact

Real = NDArray[np.float64]
Index = NDArray[np.intp]

WHEELED = tuple(plant for plant in PLANTS if plant != "single_integrator")
"""Plants that have wheels to command."""

_NID = NearIdentityDiffeomorphism(COLLISION_CENTRE)  # worlds are driven by their projected points
_FLOOR = Arena(ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y, walls=False)  # a wall would hide that a script drives off it


@dataclass(frozen=True, eq=False)
class Record:
    """What happened, row 0 the start.

    Attributes:
        t: (T,) seconds.
        poses: (T, N, 3) of the axles, metres and radians, headings not wrapped.
        commands: (T, N, 2) v and omega as commanded for the period that ends at t, m/s and rad/s.
        wheel_speeds: (T, N, 2) of the commands, rad/s, unclipped.
        contacts: (T, N) whom each robot touched; see :class:`robots.worlds.World`.
    """

    t: Real
    poses: Real
    commands: Real
    wheel_speeds: Real
    contacts: Index


class Simulation:
    """N robots on the testbed's floor.

    Args:
        poses: (N, 3) at which they stand.
        robot: what they are.
        plant: one of :data:`WHEELED`.
        held: whether on ``pymunk`` axles go exactly where wheels carry them; see :meth:`_compensated`.
        measured: the robots as logs and firmware show them, on the plants that have them; None for the data sheet's.
        draws: whose spawned streams measured robots draw from.

    Attributes:
        seen: (N, 3) poses of the axles as the cameras give them: the true ones of the data sheet's robots.
        motion: (N, 2) v and omega of the last period as the axles moved, m/s and rad/s.
        turned: (N, 2) by how much the wheels turned in it, left and right, radians.
    """

    def __init__(
        self,
        poses: Real,
        robot: RobotModel,
        plant: str,
        held: bool = True,
        measured: MeasuredModel | None = None,
        draws: np.random.Generator | None = None,
    ) -> None:
        self._robot, self._plant, self._held, self._measured = robot, plant, held, measured
        self._draws = np.random.default_rng(0) if draws is None else draws
        self.place(poses)

    def place(self, poses: Real) -> None:
        """Stand at poses (N, 3), with no past."""
        self._world = make_world(
            self._plant,
            _NID.project(poses),
            poses[:, 2],
            nid=_NID,
            robot=self._robot,
            saturation="clip",
            arena=_FLOOR,
            measured=self._measured,
            generators=[self._draws],
        )
        self._observe()
        self.motion = np.zeros((len(poses), 2))
        # Poses, commanded twists and contacts of a moment in one place: an interrupt between two lists would part them.
        self._rows = [(self._world.poses.copy(), np.zeros((len(poses), 2)), self._world.contacts.copy())]

    @property
    def poses(self) -> Real:
        """(N, 3) of the axles, headings not wrapped."""
        return self._rows[-1][0]

    @property
    def steps(self) -> int:
        """Periods since the start."""
        return len(self._rows) - 1

    def step(self, twist: Real) -> None:
        """Advance by one control period at commanded twists (N, 2)."""
        before, velocity = self.poses, _NID.velocity(self._compensated(twist))
        self._world.step(lambda points, headings, elapsed: velocity, CONTROL_PERIOD)
        after = self._world.poses.copy()
        self.motion = _motion(before, after)
        self._observe()
        self._rows.append((after, np.array(twist), self._world.contacts.copy()))

    def _compensated(self, twist: Real) -> Real:
        """(N, 2) what to command so that axles move as ``twist`` (N, 2) says.

        Chipmunk moves a body along the tangent of its way for a whole substep. The centre of mass of a robot that
        turns, r ahead of its axle, leaves its circle by r (omega dt)^2 / 2 each time and takes the axle along: forward,
        so that a controller that looks at its goal from there never comes to rest. So much less forward is commanded.
        """
        if not (self._held and isinstance(self._world, Contact)):
            return twist
        drive = self._robot.drive
        limited = drive.twist(drive.saturate(drive.wheel_speeds(twist), "clip"))
        limited[:, 0] -= self._robot.chassis.centre_offset * limited[:, 1] ** 2 * CONTROL_PERIOD / SUBSTEPS / 2.0
        return limited

    def _observe(self) -> None:
        world = self._world
        self.seen = world.seen_poses if isinstance(world, Measured) else world.poses.copy()
        self.turned = CONTROL_PERIOD * (world.rolled if isinstance(world, Measured) else world.wheel_speeds)

    def recorded(self) -> Record:
        """All that happened so far."""
        poses, commands, contacts = map(np.stack, zip(*self._rows[:], strict=True))  # another thread may be stepping
        t = CONTROL_PERIOD * np.arange(len(poses), dtype=np.float64)
        return Record(t, poses, commands, self._robot.drive.wheel_speeds(commands), contacts)


def _motion(before: Real, after: Real) -> Real:
    """(N, 2) the constant twist along whose arc poses (N, 3) went forward from ``before`` to ``after``."""
    way, turn = after[:, :2] - before[:, :2], after[:, 2] - before[:, 2]
    middle = before[:, 2] + turn / 2.0
    chord = way[:, 0] * np.cos(middle) + way[:, 1] * np.sin(middle)
    return np.stack([chord / np.sinc(turn / (2.0 * np.pi)), turn], axis=1) / CONTROL_PERIOD
