"""The decentralised filter: every robot solves its own two-variable problem from what it senses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robots.arena import Arena
from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism
from robots.obstacles import Obstacle, pack
from robots.safety.barrier import FilterSettings
from robots.safety.crowd import LARGE
from robots.safety.protocol import BLOCKERS, Noise, Real
from robots.safety.rows import Things, constants, things
from robots.safety.step import filter_step, room
from robots.senses.noise import silence
from robots.worlds import lanes
from robots.worlds.lanes import COS, GX, NOW, PX, SEEN_X, UX, VX, Senses

_LATE = Senses(PX, COS, SEEN_X)


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
        n, runs = shape[-1], int(np.prod(shape[:-1]))
        self._shape = shape
        self._constants = constants(settings, drive, nid, n)
        together = 1 if n > LARGE else runs  # a large crowd is searched run by run
        sizes = [min(together, runs - first) for first in range(0, runs, max(together, 1))]
        self._states = [lanes.at_rest(n, size) for size in sizes]
        self._blockers = [np.full((n, size, BLOCKERS), -1, dtype=np.int32) for size in sizes]
        self._among(things(arena))
        self._tell()

    def avoid(self, obstacles: Sequence[Obstacle]) -> None:
        """See :class:`robots.safety.SafetyFilter`."""
        self._among(Things(self._things.walls, *pack(obstacles)))

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
        n = self._shape[-1]
        given = {PX: points, COS: headings, GX: feedback, VX: common} | ({} if seen is None else {SEEN_X: seen})
        u, first = np.empty((int(np.prod(self._shape[:-1])), n, 2)), 0
        for state, blockers, work in zip(self._states, self._blockers, self._rooms, strict=True):
            part = slice(first, first + state.shape[2])
            for field, vectors in given.items():
                state[field : field + 2] = vectors.reshape(-1, n, 2)[part].T
            heard = silence(state.shape[2]) if noise is None else noise._replace(keys=noise.keys.reshape(-1)[part])
            senses = NOW if seen is None else _LATE
            filter_step(state, blockers, float(period), senses, self._constants, self._things, heard, work)
            u[part] = state[UX : UX + 2].T
            first = part.stop
        self._tell()
        return u.reshape(points.shape)

    def _among(self, around: Things) -> None:
        """Take what stands still around the robots."""
        self._things = around
        self._rooms = [room(self._shape[-1], state.shape[2], around) for state in self._states]

    def _tell(self) -> None:
        """Say what the last period has left in the states."""
        self.intervention, self.relaxation = self._told(lanes.INTERVENTION), self._told(lanes.RELAXATION)
        self.stuck = self._told(lanes.STUCK)
        each = [blockers.transpose(1, 0, 2) for blockers in self._blockers]
        self.blockers: NDArray[np.int32] = np.concatenate(each).reshape(*self._shape, BLOCKERS)

    def _told(self, field: int) -> Real:
        """A field of the states, (..., n)."""
        return np.concatenate([state[field].T for state in self._states]).reshape(self._shape)
