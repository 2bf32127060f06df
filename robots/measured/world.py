"""The world of the measured robots: any world with wheels, behind the firmware, under the cameras.

Robots have two sets of numbers. Commands become wheel speeds by the data sheet's, as firmware and testbed do it; wheels
become motion by each robot's own. What the law is given is what the cameras say.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from robots.drive import DifferentialDrive, Saturation
from robots.measured.camera import Camera
from robots.measured.link import Link
from robots.measured.model import MeasuredModel
from robots.measured.streams import Streams
from robots.measured.wheels import WheelLoop
from robots.nid import NearIdentityDiffeomorphism
from robots.worlds.protocol import Controller, Index, Real

_NORMALS, _UNIFORMS = 6, 2  # x, y, theta and jitter of the cameras, slip of v and omega; lost, stale
_LARGEST_SPREAD = 4.0  # deviations: no robot is built worse


class Body(Protocol):
    """A world that can be moved by the twists of its axles."""

    poses: Real
    points: Real
    headings: Real
    contacts: Index

    def move(self, twist: Real, period: float) -> None:
        """Advance by a period, seconds, at twists (..., n, 2) of the axles, m/s and rad/s."""
        ...

    def push(self, displacement: Real) -> None:
        """See :class:`robots.worlds.World`."""
        ...

    def stand(self, there: Sequence[bool]) -> None:
        """See :class:`robots.worlds.World`."""
        ...


class Measured:
    """A world around a body; poses, points and headings are true, :attr:`seen` is what the cameras say.

    Args:
        body: what moves.
        nid: where the projected points are.
        drive: of the data sheet.
        saturation: what happens at the wheels' limit, before the robots hear of it.
        model: the constants.
        generators: of the runs; streams are spawned from them.

    Attributes:
        wheel_speeds: (..., n, 2) commanded speeds, rad/s: it is commands that the testbed judges.
        rolled: (..., n, 2) mean speeds at which the wheels turned in the last period, rad/s.
        seen_poses: (..., n, 3) as the cameras say.
        radius, base: (..., n) of each robot, metres.
    """

    def __init__(
        self,
        body: Body,
        nid: NearIdentityDiffeomorphism,
        drive: DifferentialDrive,
        saturation: Saturation,
        model: MeasuredModel,
        generators: Sequence[np.random.Generator],
    ) -> None:
        robots = body.poses.shape[:-1]
        self._body, self._nid, self._drive, self._saturation = body, nid, drive, saturation
        self._model = model
        self._to_wheels = (drive.to_wheels @ nid.to_twist).T
        self._streams = Streams(generators, robots[:-1], robots[-1], _NORMALS, _UNIFORMS)
        spread = np.clip(self._streams.once(2), -_LARGEST_SPREAD, _LARGEST_SPREAD)
        self.radius = model.numbers.wheel_radius * (1.0 + model.radius_spread * spread[..., 0])
        self.base = model.numbers.base_length * (1.0 + model.base_spread * spread[..., 1])
        self._loop = WheelLoop((*robots, 2), model)
        self._link = Link(robots, drive, model)
        self._camera = Camera(body.poses, model)
        self.wheel_speeds = np.zeros((*robots, 2))
        self.rolled = np.zeros((*robots, 2))
        self._observe()

    def step(self, controller: Controller, period: float) -> None:
        normal, luck = self._streams.period()
        self.wheel_speeds = self._drive.saturate(controller(*self.seen, 0.0) @ self._to_wheels, self._saturation)
        before = self._link.wish
        after = self._link.send(self.wheel_speeds, luck[..., 0], period)
        self.rolled = self._loop.advance(before, after, self._model.command_delay, period)
        self._body.move(self._twist(self.rolled, normal[..., 4:], period), period)
        self._camera.take(self._body.poses, normal[..., :4], luck[..., 1], period)
        self._observe()

    def push(self, displacement: Real) -> None:
        self._body.push(displacement)
        self._observe()

    def stand(self, there: Sequence[bool]) -> None:
        self._body.stand(there)

    def _twist(self, wheels: Real, normal: Real, period: float) -> Real:
        """(..., n, 2) of the axles, by each robot's own numbers and with its slip."""
        numbers = self._model.numbers
        left, right = self.radius * wheels[..., 0], self.radius * wheels[..., 1]
        v, omega = (left + right) / 2.0, (right - left) / self.base
        way, angle = np.abs(v) * period, np.abs(omega) * period
        along = numbers.slip_along * np.sqrt(way)
        turning = np.sqrt(numbers.slip_heading**2 * way + numbers.slip_turning**2 * angle)
        return np.stack([v + along * normal[..., 0] / period, omega + turning * normal[..., 1] / period], axis=-1)

    def _observe(self) -> None:
        body, self.seen_poses = self._body, self._camera.seen
        theta = self.seen_poses[..., 2]
        self.poses, self.points, self.headings, self.contacts = body.poses, body.points, body.headings, body.contacts
        self.seen = self._nid.project(self.seen_poses), np.stack([np.cos(theta), np.sin(theta)], axis=-1)
