"""The centralised filter: the rows of the decentralised one, shared between robots as one QP likes it best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robots.arena import Arena
from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism
from robots.obstacles import Obstacle
from robots.safety.barrier import WHEEL_MARGIN, FilterSettings, turn_weight
from robots.safety.joint import Index, JointFilter, Rows, disturbed, things
from robots.safety.protocol import Noise, Real


class CentralisedFilter(JointFilter):
    """Minimise sum_i |u_i - (v_r + s g)|^2 subject to n.(v_i - v_j) >= -gamma h / (2 D) for every pair within the
    sensing range, the rows of walls and obstacles, and the wheels.

    It needs to know all positions and headings. Nobody answers for half: a robot that stands still where it belongs is
    pushed aside if that is cheapest. It declares deadlocks and leaves them; only the decentralised filter breaks them.
    """

    def __init__(
        self,
        shape: tuple[int, ...],
        drive: DifferentialDrive,
        nid: NearIdentityDiffeomorphism,
        settings: FilterSettings,
        arena: Arena | None = None,
    ) -> None:
        super().__init__(shape)
        self._settings = settings
        self._walls = np.empty((0, 3)) if arena is None else arena.wall_planes
        self._obstacles = () if arena is None else arena.obstacles
        self._codes = things(self._n, len(self._walls), len(self._obstacles))
        self._limit, self._weight = float(drive.speed_limit) * (1.0 - WHEEL_MARGIN), turn_weight(drive, nid)

    def avoid(self, obstacles: Sequence[Obstacle]) -> None:
        """See :class:`robots.safety.SafetyFilter`."""
        self._obstacles = tuple(obstacles)

    def _wish(self, law: Real, common: Real, frame: NDArray[np.complex128]) -> Real:
        directions, limit = self._wheels(frame)
        sides = np.concatenate([directions, -directions], axis=1)
        slope, base = (sides * law[:, None]).sum(axis=-1), (sides * common[:, None]).sum(axis=-1)
        room = np.maximum(limit - base, 0.0)
        share = np.divide(room, slope, out=np.ones_like(room), where=slope > room).min(axis=1)
        return common + share[:, None] * law

    def _wheels(self, frame: NDArray[np.complex128]) -> tuple[Real, float]:
        sides = np.array([1.0 + 1j * self._weight, 1.0 - 1j * self._weight])
        return (frame * sides)[..., None].view(np.float64), self._limit

    def _rows(self, run: int, points: Real, frame: NDArray[np.complex128], noise: Noise | None) -> Rows:
        settings = self._settings
        first, second = _pairs(points, settings.sensing_range)
        e = disturbed(points[first] - points[second], frame, noise, run, first, second)
        distance = np.linalg.norm(e, axis=1)
        lower = -settings.gain * (distance**2 - settings.safe_distance**2) / (2.0 * distance)
        gap, away = self._gaps(points)
        reach = settings.clearance + settings.sensing_range - settings.safe_distance
        robot, thing = np.nonzero(gap < reach)
        d = gap[robot, thing]
        seen = disturbed(d[:, None] * away[robot, thing], frame, noise, run, robot, self._codes[thing])
        signed = np.copysign(np.linalg.norm(seen, axis=1), d)
        direction = np.divide(seen, signed[:, None], out=away[robot, thing], where=signed[:, None] != 0.0)
        return Rows(
            np.concatenate([first, robot]),
            np.concatenate([second, np.full(len(robot), -1)]),
            np.concatenate([second, self._codes[thing]]),
            np.concatenate([e / distance[:, None], direction]),
            np.concatenate([lower, -settings.gain * (signed - settings.clearance)]),
        )

    def _gaps(self, points: Real) -> tuple[Real, Real]:
        """Signed distances (n, W + O), metres, from walls and obstacles, and the unit vectors (n, W + O, 2) away."""
        gaps = [points @ self._walls[:, :2].T - self._walls[:, 2]]
        away = [np.broadcast_to(self._walls[:, :2], (len(points), len(self._walls), 2))]
        for obstacle in self._obstacles:
            distance, direction = obstacle.nearest(points)
            gaps.append(distance[:, None])
            away.append(direction[:, None])
        return np.concatenate(gaps, axis=1), np.concatenate(away, axis=1)


def _pairs(points: Real, reach: float) -> tuple[Index, Index]:
    """Rows of the robots closer than ``reach``, metres, and not in one place, first < second."""
    z = np.ascontiguousarray(points).view(np.complex128)[:, 0]
    distance = np.abs(z[:, None] - z)
    first, second = np.nonzero(np.triu((distance < reach) & (distance > 0.0), 1))
    return first, second
