"""The decentralised filter: every robot solves its own two-variable problem from what it senses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robots.arena import Arena
from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism
from robots.obstacles import Obstacle, pack
from robots.safety import kernel
from robots.safety.barrier import FilterSettings
from robots.safety.protocol import BLOCKERS, Noise, Real
from robots.safety.rows import constants


class DecentralisedFilter:
    """One period of robot i, with g the law without v_r, all in its body frame:

    1. turn g left by ``turn`` max_j (how near j is) (how much g drives at j) + (what a stuck robot adds), to the right
       once the left has led nowhere;
    2. scale g by the largest s <= 1 that keeps v_r + s g within the wheels' limits;
    3. minimise |u - (v_r + s g)|^2 subject to the rows of :mod:`robots.safety.barrier`; if no u satisfies them, lower
       all but the wheels' by the least amount that helps;
    4. count the time tau without progress.

    Robots, walls and obstacles enter by relative position within the sensing range and by nothing else. One robot's
    infeasible problem changes no other robot's.

    Args:
        shape: (..., n) of the runs that advance together.
        arena: its walls and obstacles; None for an endless floor.
    """

    distributed = True

    def __init__(
        self,
        shape: tuple[int, ...],
        drive: DifferentialDrive,
        nid: NearIdentityDiffeomorphism,
        settings: FilterSettings,
        arena: Arena | None = None,
    ) -> None:
        self._constants = constants(settings, drive, nid, shape[-1])
        self._walls = np.empty((0, 3)) if arena is None else arena.wall_planes
        self._obstacles = pack(() if arena is None else arena.obstacles)
        batch = (int(np.prod(shape[:-1])), shape[-1])
        self._silence = np.empty((*batch, 0, 2))
        self.intervention = np.zeros(shape)
        self.relaxation = np.zeros(shape)
        self.blockers: NDArray[np.int64] = np.full((*shape, BLOCKERS), -1, dtype=np.int64)
        self.stuck = np.zeros(shape)
        self._side = np.ones(batch)
        self._batch = batch

    def avoid(self, obstacles: Sequence[Obstacle]) -> None:
        """See :class:`robots.safety.SafetyFilter`."""
        self._obstacles = pack(obstacles)

    def filter(
        self,
        points: Real,
        headings: Real,
        feedback: Real,
        common: Real,
        period: float,
        noise: Noise | None = None,
        seen: Real | None = None,
    ) -> Real:
        """See :class:`robots.safety.SafetyFilter`.

        ``seen`` (..., n, 2) is where each robot was when the others sensed it, metres; where it is, if absent.
        """
        u = np.empty(points.shape)
        batch = (*self._batch, 2)
        turns, offsets = self._silence, self._silence
        if noise is not None:
            full = (*self._batch, -1, 2)
            turns, offsets = noise.turns.reshape(full), noise.offsets.reshape(full)
        kernel.step(
            points.reshape(batch),
            (points if seen is None else seen).reshape(batch),
            headings.reshape(batch),
            feedback.reshape(batch),
            common.reshape(batch),
            self.stuck.reshape(self._batch),
            self._side,
            float(period),
            self._constants,
            self._walls,
            *self._obstacles,
            turns,
            offsets,
            u.reshape(batch),
            self.intervention.reshape(self._batch),
            self.relaxation.reshape(self._batch),
            self.blockers.reshape(*self._batch, BLOCKERS),
        )
        return u
