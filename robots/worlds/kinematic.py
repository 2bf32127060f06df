"""Worlds without mass or contact: the theorem's points, the unicycle, and the unicycle with wheel limits.

All three accept any leading batch dimensions, so that many runs advance as one array.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robots.drive import DifferentialDrive, Saturation
from robots.nid import NearIdentityDiffeomorphism, mapped
from robots.worlds.protocol import NOTHING, Controller, Real

Complex = NDArray[np.complex128]


class SingleIntegrator:
    """Points with dp/dt = u, the paper's eq. (p), integrated by the classical Runge-Kutta method of order four.

    Each point keeps the frame it was given: its heading is that frame's x axis and never turns.
    """

    def __init__(self, points: Real, theta: Real, steps: int = 1) -> None:
        """Take points (..., n, 2), metres, frames theta (..., n), radians, and so many steps in a control period."""
        self._steps = steps
        self.points = np.array(points, dtype=np.float64)
        self.poses = np.concatenate([self.points, theta[..., None]], axis=-1)
        self.headings = _unit(theta)
        self.wheel_speeds = np.full_like(self.points, np.nan)
        self.contacts = np.full(self.points.shape[:-1], NOTHING)

    @property
    def seen(self) -> tuple[Real, Real]:
        return self.points, self.headings

    def step(self, controller: Controller, period: float) -> None:
        h, frame = period / self._steps, self.headings.view(np.complex128)

        def derivative(points: Real, elapsed: float) -> Real:
            return (controller(points, self.headings, elapsed).view(np.complex128) * frame).view(np.float64)

        for step in range(self._steps):
            begin, p = step * h, self.points
            k1 = derivative(p, begin)
            k2 = derivative(p + (h / 2.0) * k1, begin + h / 2.0)
            k3 = derivative(p + (h / 2.0) * k2, begin + h / 2.0)
            k4 = derivative(p + h * k3, begin + h)
            self.points = p + (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4)
        self.poses[..., :2] = self.points

    def push(self, displacement: Real) -> None:
        self.points = self.points + displacement
        self.poses[..., :2] = self.points

    def stand(self, there: Sequence[bool]) -> None:
        """Nothing stops a point."""


class Unicycle:
    """Unicycles that follow every command: the NID map on exact arcs, without limits.

    The command is held over the period, as a digital controller does, and the arc is integrated in closed form.
    """

    def __init__(self, poses: Real, nid: NearIdentityDiffeomorphism, drive: DifferentialDrive) -> None:
        self.poses = np.array(poses, dtype=np.float64)
        self._l = nid.ahead
        self._to_wheels = (drive.to_wheels @ nid.to_twist).swapaxes(-1, -2)
        self._to_twist = drive.to_twist.T
        self._drive = drive
        self.wheel_speeds = np.zeros_like(self.poses[..., :2])
        self.contacts = np.full(self.poses.shape[:-1], NOTHING)
        self._observe()

    @property
    def seen(self) -> tuple[Real, Real]:
        return self.points, self.headings

    def step(self, controller: Controller, period: float) -> None:
        self.wheel_speeds = self._limited(mapped(controller(self.points, self.headings, 0.0), self._to_wheels))
        self.move(self.wheel_speeds @ self._to_twist, period)

    def move(self, twist: Real, period: float) -> None:
        """Advance by a period, seconds, at twists (..., n, 2) of the axles, m/s and rad/s."""
        turn = twist[..., 1] * period
        chord = arc_chord(twist[..., 0] * period, self.poses[..., 2], turn)
        self.poses[..., :2] += chord[..., None].view(np.float64)
        self.poses[..., 2] += turn
        self._observe()

    def push(self, displacement: Real) -> None:
        self.poses[..., :2] += displacement
        self._observe()

    def stand(self, there: Sequence[bool]) -> None:
        """Nothing stops a body without mass."""

    def _limited(self, wheel_speeds: Real) -> Real:
        return wheel_speeds

    def _observe(self) -> None:
        self.headings = _unit(self.poses[..., 2])
        self.points = self.poses[..., :2] + self._l * self.headings


class Saturated(Unicycle):
    """Unicycles whose wheels have a speed limit."""

    def __init__(
        self,
        poses: Real,
        nid: NearIdentityDiffeomorphism,
        drive: DifferentialDrive,
        saturation: Saturation = "scale",
    ) -> None:
        super().__init__(poses, nid, drive)
        self._saturation: Saturation = saturation

    def _limited(self, wheel_speeds: Real) -> Real:
        return self._drive.saturate(wheel_speeds, self._saturation)


def arc_chord(length: Real, theta: Real, turn: Real) -> Complex:
    """The chord of an arc of ``length`` (...), metres, that begins at heading ``theta`` and turns by ``turn``, radians.

    A body that moves at constant twist covers (e^{i turn} - 1) / (i turn) of its path, relative to its first heading.
    Written as e^{i turn / 2} sin(turn / 2) / (turn / 2) it keeps full accuracy for small turns. Complex (...).
    """
    half = 0.5 * turn
    half[half == 0.0] = 1e-300  # sin(x) / x is 1 there, without a division by 0
    share = np.sin(half)
    share /= half
    share *= length
    half += theta
    return np.exp(1j * half) * share


def _unit(theta: Real) -> Real:
    return np.exp(1j * theta)[..., None].view(np.float64)
