"""The public simulator's barrier certificate, with its defaults: the reference that users of the Robotarium know.

Wang, Ames, Egerstedt 2017, "Safety barrier certificates for collisions-free multirobot systems", as ``rps`` states it
for single integrators with a boundary, ``create_single_integrator_barrier_certificate_with_boundary`` until 2.0: of all
velocities the nearest to the wished ones, cut to 0.2 m/s each, with

    2 e_ij.(v_i - v_j) >= -gamma h^3,     h = |e_ij|^2 - 0.17^2,     e_ij = c_i - c_j,     every pair,
    n.v_i >= -0.4 gamma (d - 0.17 / 2)^3,                                                  every side of the floor,

gamma = 100, d the distance from the side with the inward normal n. All robots, no wheel limits, no way out of a
deadlock. ``rps`` 2.1 keeps the rows, in ``create_si_barrier_certificate_with_boundary``; it takes 0.15 m, a boundary
0.1 m beyond the floor, and eight rows per robot instead of the cut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.safety.joint import JointFilter, Rows, disturbed, things
from robots.safety.protocol import WALLS, Noise, Real

SAFETY_RADIUS = 0.17
"""Metres between two robots (``rps`` 2.0)."""

BARRIER_GAIN = 100.0
"""1/(m^4 s) (``rps`` 2.0)."""

BOUNDARY_SHARE = 0.4
"""Share of the gain at the boundary (``rps`` 2.0)."""

MAGNITUDE_LIMIT = 0.2
"""m/s to which wishes are cut (``rps`` 2.0)."""


class RobotariumCertificate(JointFilter):
    """The certificate for all robots on a floor; obstacles are unknown to it.

    Args:
        shape: (..., n) of the runs.
        arena: its sides are the boundary, whether they are walls or not.
    """

    def __init__(self, shape: tuple[int, ...], arena: Arena | None = None) -> None:
        super().__init__(shape)
        self._sides = (arena or ROBOTARIUM_FLOOR).half_planes
        self._first, self._second = np.triu_indices(self._n, 1)
        self._robot = np.repeat(np.arange(self._n), WALLS)
        self._side = np.tile(np.arange(WALLS), self._n)
        self._codes = things(self._n, WALLS, 0)[self._side]

    def _wish(self, law: Real, common: Real, frame: NDArray[np.complex128]) -> Real:
        wish = law + common
        speed = np.linalg.norm(wish, axis=1, keepdims=True)
        return wish * (MAGNITUDE_LIMIT / np.maximum(speed, MAGNITUDE_LIMIT))

    def _wheels(self, frame: NDArray[np.complex128]) -> tuple[Real, float]:
        return np.empty((self._n, 0, 2)), np.inf

    def _rows(self, run: int, points: Real, frame: NDArray[np.complex128], noise: Noise | None) -> Rows:
        first, second = self._first, self._second
        e = disturbed(points[first] - points[second], frame, noise, run, first, second)
        h = (e**2).sum(axis=1) - SAFETY_RADIUS**2
        inward = self._sides[self._side, :2]
        gap = (points[self._robot] * inward).sum(axis=1) - self._sides[self._side, 2]
        edge = -BOUNDARY_SHARE * BARRIER_GAIN * (gap - SAFETY_RADIUS / 2.0) ** 3
        return Rows(
            np.concatenate([first, self._robot]),
            np.concatenate([second, np.full(len(self._robot), -1)]),
            np.concatenate([second, self._codes]),
            np.concatenate([2.0 * e, inward]),
            np.concatenate([-BARRIER_GAIN * h**3, edge]),
        )
