"""The public simulator's barrier certificate, with its defaults: the reference that users of the Robotarium know.

Wang, Ames, Egerstedt 2017, "Safety barrier certificates for collisions-free multirobot systems", as ``rps`` 2.1 states
it in ``create_si_barrier_certificate_with_boundary``: of all velocities the nearest to the wished ones with

    2 e_ij.(v_i - v_j) >= -gamma h^3,     h = |e_ij|^2 - 0.15^2,     e_ij = c_i - c_j,     every pair,
    n.v_i >= -0.4 gamma (d - 0.15 / 2)^3,                                                  every side of the boundary,
    |a.v_i| <= 0.2 m/s cos(pi / 8),                                                        a every 45 degrees,

gamma = 100, d the distance from the side with the inward normal n, the boundary 0.1 m beyond the floor. All robots, no
wheel limits, no way out of a deadlock. Until 2.0 the distance was 0.17 m, the boundary the floor's, and the wish was
cut instead of the solution.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.obstacles import Obstacle
from robots.safety.joint import JointFilter, Rows, disturbed, things
from robots.safety.protocol import WALLS, Noise, Real

SAFETY_RADIUS = 0.15
"""Metres between two robots (``rps`` 2.1)."""

BARRIER_GAIN = 100.0
"""1/(m^4 s) (``rps`` 2.1)."""

BOUNDARY_SHARE = 0.4
"""Share of the gain at the boundary (``rps`` 2.1)."""

BOUNDARY_MARGIN = 0.1
"""Metres from the floor's sides out to the boundary (``rps`` 2.1)."""

MAGNITUDE_LIMIT = 0.2
"""m/s, of the circle in which velocities stay; their octagon lies within it (``rps`` 2.1)."""

_OCTAGON = np.exp(0.25j * np.pi * np.arange(4))[:, None].view(np.float64)


class RobotariumCertificate(JointFilter):
    """The certificate for all robots on a floor; obstacles are unknown to it.

    Args:
        shape: (..., n) of the runs.
        arena: its sides are the boundary, whether they are walls or not.
        safety_radius: metres between two robots.
        gain: 1/(m^4 s).
        magnitude_limit: m/s that no robot exceeds.
        margin: metres from the arena's sides out to the boundary.
    """

    def __init__(
        self,
        shape: tuple[int, ...],
        arena: Arena | None = None,
        safety_radius: float = SAFETY_RADIUS,
        gain: float = BARRIER_GAIN,
        magnitude_limit: float = MAGNITUDE_LIMIT,
        margin: float = BOUNDARY_MARGIN,
    ) -> None:
        super().__init__(shape)
        self._safety_radius, self._gain, self._margin = safety_radius, gain, margin
        self._limit = magnitude_limit * np.cos(np.pi / 8.0)
        self._sides = (arena or ROBOTARIUM_FLOOR).half_planes
        self._first, self._second = np.triu_indices(self._n, 1)
        self._robot = np.repeat(np.arange(self._n), WALLS)
        self._side = np.tile(np.arange(WALLS), self._n)
        self._codes = things(self._n, WALLS, 0)[self._side]

    def avoid(self, obstacles: Sequence[Obstacle]) -> None:
        """It knows of none."""

    def _wish(self, law: Real, common: Real, frame: NDArray[np.complex128]) -> Real:
        return law + common

    def _wheels(self, frame: NDArray[np.complex128]) -> tuple[Real, float]:
        return np.tile(_OCTAGON, (self._n, 1, 1)), self._limit

    def _rows(self, run: int, points: Real, frame: NDArray[np.complex128], noise: Noise | None) -> Rows:
        first, second = self._first, self._second
        e = disturbed(points[first] - points[second], frame, noise, run, first, second)
        h = (e**2).sum(axis=1) - self._safety_radius**2
        inward = self._sides[self._side, :2]
        gap = (points[self._robot] * inward).sum(axis=1) - self._sides[self._side, 2]
        edge = -BOUNDARY_SHARE * self._gain * (gap + self._margin - self._safety_radius / 2.0) ** 3
        return Rows(
            np.concatenate([first, self._robot]),
            np.concatenate([second, np.full(len(self._robot), -1)]),
            np.concatenate([second, self._codes]),
            np.concatenate([2.0 * e, inward]),
            np.concatenate([-self._gain * h**3, edge]),
        )
