"""The closed loop dp/dt = u(p) near an equilibrium, for any law: its derivative by differences, its modes, its clock.

On a leader-first-follower graph a local law makes a cascade: u_k depends on p_k and on agents with smaller numbers. The
derivative is then block triangular, exactly, and its eigenvalues are those of the blocks of two rows that belong to
one agent: each mode has an owner, and repeated modes of the whole cascade do not blur each other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from formation.plane import Complex, Real

ZERO_RATE = 1e-6
"""A mode slower than this, 1/s, counts as not moving at all; also the error from which a derivative counts as none."""


@dataclass(frozen=True, eq=False)
class Linearisation:
    """The derivative of the velocities of n agents by their positions.

    Attributes:
        matrix: (2n, 2n) derivative, 1/s; two rows and two columns, x and y, for each agent.
        bound: by how much, 1/s, any entry may be off, as measured; large where the law is not smooth.
    """

    matrix: Real
    bound: float

    @property
    def n(self) -> int:
        """Number of agents."""
        return len(self.matrix) // 2

    @property
    def smooth(self) -> bool:
        """Whether the law has a derivative there, to :data:`ZERO_RATE`."""
        return self.bound < ZERO_RATE

    @cached_property
    def cascade(self) -> bool:
        """Whether no agent depends on one with a larger number."""
        later = np.triu(np.ones((self.n, self.n), dtype=bool), k=1)
        return not (self.matrix[np.kron(later, np.ones((2, 2), dtype=bool))]).any()

    @cached_property
    def modes(self) -> Complex:
        """(n, 2) eigenvalues, 1/s; row k holds those of agent k if the loop is a :attr:`cascade`."""
        if not self.cascade:
            return np.linalg.eigvals(self.matrix).astype(np.complex128).reshape(-1, 2)
        blocks = self.matrix.reshape(self.n, 2, self.n, 2)[np.arange(self.n), :, np.arange(self.n), :]
        return np.linalg.eigvals(blocks).astype(np.complex128)

    @property
    def moving(self) -> NDArray[np.bool_]:
        """(n, 2) which modes move: all others are a freedom that the law leaves."""
        return np.abs(self.modes) > ZERO_RATE

    @property
    def zero_modes(self) -> int:
        """How many modes do not move."""
        return int((~self.moving).sum())

    @property
    def largest_period(self) -> float:
        """The control period, seconds, below which every moving mode decays where commands are held over a period.

        A held command moves a mode by the factor 1 + T lambda, which is less than 1 in magnitude for
        T < -2 Re(lambda) / |lambda|^2. Infinite where nothing moves, 0 where a mode does not decay.
        """
        modes = self.modes[self.moving]
        if not modes.size:
            return np.inf
        return max(0.0, float((-2.0 * modes.real / np.abs(modes) ** 2).min()))


def linearise(velocity: Callable[[Real], Real], points: Real, step: float) -> Linearisation:
    """The derivative at ``points`` (n, 2), metres, of a function that takes positions to velocities (n, 2), m/s.

    Central differences over steps of h, h/2 and h/4 give two extrapolations to h = 0, of fourth order; what they
    differ by bounds the error. So does the jump of the slope between both sides, extrapolated alike: zero but for a
    kink, which central differences alone do not see.

    Args:
        velocity: the closed loop, all positions and velocities in one frame.
        points: where.
        step: h, metres; far below every length of the law and of the formation.
    """
    here = velocity(points).ravel()
    slopes, jumps = zip(*(_differences(velocity, points, here, h) for h in (step, step / 2.0, step / 4.0)), strict=True)
    coarse, fine = ((4.0 * slopes[i + 1] - slopes[i]) / 3.0 for i in (0, 1))
    kink = (4.0 * jumps[2] - jumps[0]) / 3.0
    bound = float(np.maximum(np.abs(fine - coarse), np.abs(kink)).max())
    return Linearisation(fine, bound if np.isfinite(bound) else np.inf)


def _differences(velocity: Callable[[Real], Real], points: Real, here: Real, h: float) -> tuple[Real, Real]:
    """(2n, 2n) central differences, and slope ahead minus slope behind, both 1/s; columns are the coordinates moved."""
    slope, jump = np.empty((2, here.size, points.size))
    for column in range(points.size):
        move = np.zeros(points.size)
        move[column] = h
        ahead, behind = (velocity(points + sign * move.reshape(points.shape)).ravel() for sign in (1.0, -1.0))
        slope[:, column] = (ahead - behind) / (2.0 * h)
        jump[:, column] = (ahead - here - (here - behind)) / h
    return slope, jump
