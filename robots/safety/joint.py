"""Filters that plan for all robots at once: one QP a period, in world-frame velocities, solved by DAQP.

DAQP (Arnstroem et al. 2022) is a dual active-set solver in C: small, exact, maintained, without dependencies of its
own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import daqp
import numpy as np
from numpy.typing import NDArray

from robots.safety.barrier import STUCK_PROGRESS, STUCK_RECOVERY, STUCK_WISH
from robots.safety.protocol import BLOCKERS, WALLS, Noise, Real

Index = NDArray[np.intp]

_PENALTY = 1e4  # of a relaxation, per m/s: far above every multiplier of a problem that needs none
_RELAXED = 1e-9  # m/s below which a relaxation is rounding
_TIGHT = 1e-6  # by which DAQP itself may break a row
_DECISIVE = 1e-7  # slack up to which a row counts as one of those that decided
_UNBOUNDED = 1e30


@dataclass(frozen=True, eq=False)
class Rows:
    """Linear rows of velocities: sign_1 a.v_first - sign_2 a.v_second >= lower, the second robot absent for a thing.

    Attributes:
        first: (m,) robots.
        second: (m,) robots, or -1 for a row of a wall or an obstacle.
        codes: (m,) what the row belongs to, seen from ``first``; see :class:`robots.safety.SafetyFilter`.
        a: (m, 2) direction in which ``first`` leaves.
        lower: (m,) least value of a.(v_first - v_second).
    """

    first: Index
    second: Index
    codes: Index
    a: Real
    lower: Real

    def matrix(self, n: int) -> Real:
        """(m, 2n) the rows as a matrix."""
        m = len(self.first)
        matrix = np.zeros((m, n, 2))
        matrix[np.arange(m), self.first] = self.a
        paired = np.flatnonzero(self.second >= 0)
        matrix[paired, self.second[paired]] = -self.a[paired]
        return matrix.reshape(m, 2 * n)

    def where(self, chosen: NDArray[np.bool_]) -> Rows:
        """The rows that ``chosen`` (m,) says."""
        return Rows(self.first[chosen], self.second[chosen], self.codes[chosen], self.a[chosen], self.lower[chosen])

    def within_reach(self, speed: Real) -> NDArray[np.bool_]:
        """(m,) which rows robots could break that drive at ``speed`` (n,), m/s, wherever they head."""
        both = speed[self.first] + np.where(self.second >= 0, speed[self.second], 0.0)
        return self.lower > -both * np.linalg.norm(self.a, axis=1)

    def slack(self, v: Real, lowered: Real) -> Real:
        """(m,) by how much velocities v (n, 2), m/s, satisfy the rows, those between robots of a relaxed group lowered.

        Args:
            lowered: (n,) by how much the rows of each robot's group were lowered; a row between two groups by less.
        """
        paired = self.second >= 0
        relative = v[self.first] - np.where(paired[:, None], v[self.second], 0.0)
        allowance = np.where(paired, np.minimum(lowered[self.first], lowered[self.second]), lowered[self.first])
        return (self.a * relative).sum(axis=1) - self.lower + allowance


class JointFilter(ABC):
    """One QP over all robots of a run; a batch of runs is solved run by run.

    A subclass says what the robots wish for, which rows keep them apart and what their wheels can do.

    Most rows of a crowd are between robots too far apart to matter, and a matrix of them all grows with n^3. So the QP
    begins with the rows that robots as fast as they wish to be could break, and takes in what its solution breaks,
    until that is nothing. A solution that satisfies the rows left out is the solution with them.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.intervention = np.zeros(shape)
        self.relaxation = np.zeros(shape)
        self.blockers: NDArray[np.int32] = np.full((*shape, BLOCKERS), -1, dtype=np.int32)
        self.stuck = np.zeros(shape)
        self._runs, self._n = int(np.prod(shape[:-1])), shape[-1]

    def filter(
        self, points: Real, headings: Real, feedback: Real, common: Real, period: float, noise: Noise | None = None
    ) -> Real:
        """See :class:`robots.safety.SafetyFilter`."""
        u = np.empty(points.shape)
        shape = (self._runs, self._n, 2)
        flat = (a.reshape(shape) for a in (points, headings, feedback, common, u))
        for run, (p, heading, g, v_r, out) in enumerate(zip(*flat, strict=True)):
            frame = np.ascontiguousarray(heading).view(np.complex128)
            common_world, law = _turn(v_r, frame), _turn(g, frame)
            wish = self._wish(law, common_world, frame)
            v = self._solve(run, wish, self._rows(run, p, frame, noise), frame)
            out[:] = _turn(v, np.conj(frame))
            self.intervention.reshape(-1, self._n)[run] = np.linalg.norm(v - wish, axis=1)
            waiting = np.linalg.norm(v - common_world, axis=1), np.linalg.norm(wish - common_world, axis=1)
            _advance(self.stuck.reshape(-1, self._n)[run], *waiting, period)
        return u

    @abstractmethod
    def _wish(self, law: Real, common: Real, frame: NDArray[np.complex128]) -> Real:
        """(n, 2) world-frame velocities wished for, from the law without v_r and from v_r, m/s."""

    @abstractmethod
    def _rows(self, run: int, points: Real, frame: NDArray[np.complex128], noise: Noise | None) -> Rows:
        """What keeps the robots apart."""

    @abstractmethod
    def _wheels(self, frame: NDArray[np.complex128]) -> tuple[Real, float]:
        """(n, k, 2) directions in which a robot's velocity has a limit, world frame, and the limit, m/s."""

    def _solve(self, run: int, wish: Real, rows: Rows, frame: NDArray[np.complex128]) -> Real:
        directions, limit = self._wheels(frame)
        used = rows.within_reach(np.linalg.norm(wish, axis=1))
        while True:
            v, lowered = _solve_groups(wish, rows.where(used), directions, limit)
            slack = rows.slack(v, lowered)
            broken = ~used & (slack < -_TIGHT)
            if not broken.any():
                break
            used |= broken
        self._report(run, rows, slack, lowered)
        return v

    def _report(self, run: int, rows: Rows, slack: Real, lowered: Real) -> None:
        relaxation = self.relaxation.reshape(-1, self._n)[run]
        blockers = self.blockers.reshape(-1, self._n, BLOCKERS)[run]
        relaxation[:], blockers[:] = 0.0, -1
        for row in np.flatnonzero((lowered[rows.first] > 0.0) & (slack <= _DECISIVE)):
            for robot, code in ((rows.first[row], rows.codes[row]), (rows.second[row], rows.first[row])):
                if robot >= 0:
                    relaxation[robot] = lowered[robot]
                    free = np.flatnonzero(blockers[robot] < 0)
                    if free.size:
                        blockers[robot, free[0]] = code


def _solve_groups(wish: Real, rows: Rows, directions: Real, limit: float) -> tuple[Real, Real]:
    """The velocities (n, 2) nearest to ``wish``, m/s, and by how much each robot's rows were lowered, (n,) m/s."""
    v, lowered = wish.copy(), np.zeros(len(wish))
    for robots in groups(len(wish), rows):
        mine = rows.where(np.isin(rows.first, robots))
        first = np.searchsorted(robots, mine.first)
        second = np.where(mine.second < 0, -1, np.searchsorted(robots, mine.second))
        matrix = Rows(first, second, mine.codes, mine.a, mine.lower).matrix(len(robots))
        v[robots], lowered[robots] = nearest(wish[robots], matrix, mine.lower, _blocks(directions[robots]), limit)
    return v, lowered


def nearest(wish: Real, matrix: Real, lower: Real, hard: Real, limit: float) -> tuple[Real, float]:
    """The x (k, 2) nearest to ``wish`` with ``matrix`` x >= ``lower`` and |``hard`` x| <= ``limit``.

    Where there is none, ``lower`` is relaxed by the least uniform amount, m/s, which is returned beside x.
    """
    target = wish.ravel()
    size = len(target)
    both = np.concatenate([matrix, hard])
    low = np.concatenate([lower, np.full(len(hard), -limit)])
    high = np.concatenate([np.full(len(lower), _UNBOUNDED), np.full(len(hard), limit)])
    x, _, flag, _ = daqp.solve(np.eye(size), -target, both, high, low, np.zeros(len(low), dtype=np.int32))
    if flag == 1:
        return x.reshape(-1, 2), 0.0
    slack = np.concatenate([np.ones(len(lower)), np.zeros(len(hard))])
    both = np.concatenate([np.column_stack([both, slack]), np.eye(size + 1)[-1:]])
    low, high = np.append(low, 0.0), np.append(high, _UNBOUNDED)
    cost = np.append(-target, _PENALTY)
    x, _, _, _ = daqp.solve(np.eye(size + 1), cost, both, high, low, np.zeros(len(low), dtype=np.int32))
    return x[:size].reshape(-1, 2), float(x[size]) if x[size] > _RELAXED else 0.0


def groups(n: int, rows: Rows) -> list[Index]:
    """Robots that rows connect, each group in ascending order: what happens in one is no matter to another."""
    label = np.arange(n)
    paired = rows.second >= 0
    first, second = rows.first[paired], rows.second[paired]
    while True:
        lowest = label.copy()
        np.minimum.at(lowest, first, label[second])
        np.minimum.at(lowest, second, label[first])
        lowest = lowest[lowest]
        if (lowest == label).all():
            return [np.flatnonzero(label == value) for value in np.unique(label)]
        label = lowest


def things(n: int, walls: int, obstacles: int) -> Index:
    """Codes of the walls and obstacles among ``n`` robots."""
    return np.concatenate([n + np.arange(walls), n + WALLS + np.arange(obstacles)])


def disturbed(e: Real, frame: NDArray[np.complex128], noise: Noise | None, run: int, rows: Index, codes: Index) -> Real:
    """World-frame vectors (m, 2) from things to robots, as the robots ``rows`` measure them, metres."""
    if noise is None:
        return e
    from robots.senses.chance import pairs  # numba is loaded only where it is used

    who, what = (np.ascontiguousarray(np.broadcast_to(each, len(e)), dtype=np.int64) for each in (rows, codes))
    drawn = pairs(noise.keys.reshape(-1)[run], who, what, noise.position, noise.bearing)
    turns, offsets = drawn.view(np.complex128).T
    z = e.view(np.complex128)[:, 0] * turns - offsets * frame[rows, 0]
    return z[:, None].view(np.float64)


def _advance(stuck: Real, progress: Real, wish: Real, period: float) -> None:
    waiting = (progress < STUCK_PROGRESS * wish) & (wish > STUCK_WISH)
    stuck += np.where(waiting, period, -STUCK_RECOVERY * period)
    np.maximum(stuck, 0.0, out=stuck)


def _turn(velocities: Real, by: NDArray[np.complex128]) -> Real:
    return (np.ascontiguousarray(velocities).view(np.complex128) * by).view(np.float64)


def _blocks(directions: Real) -> Real:
    """(n k, 2n) rows of (n, k, 2) directions, each of its own robot alone."""
    n, k = directions.shape[:2]
    matrix = np.zeros((n, k, n, 2))
    robots = np.arange(n)
    matrix[robots, :, robots] = directions
    return matrix.reshape(n * k, 2 * n)
