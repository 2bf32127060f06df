"""The angle-constrained law (paper, eq. (u) and eq. (man)).

    u_k = -A_k^T (A_i e_ki + A_j e_kj)      followers k = 3..n, eq. (u)
    u_1 = 0,  u_2 = first-follower law      eq. (man) without the common velocity v_r, which the caller adds

Each follower multiplies the two relative positions that it measures by two constant complex gains. The gains commute
with rotations, so a follower may work in any local frame in SO(2) (Lemma 2); a reflected frame does not commute.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.laws.base import Law
from formation.laws.first_follower import COMPASS_FREE, EDGE_LAWS
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.target import TargetFormation


class AngleLaw(Law):
    """The law of all agents at once.

    Attributes:
        gains: (n - 2, 2) the factors -A_k^T A_i and -A_k^T A_j as complex numbers, 1/s, times each follower's own gain.
        needs_compass: whether an agent needs the common x axis in its own frame.

    Raises:
        ValueError: ``first_follower`` names no law of :data:`EDGE_LAWS`.
    """

    name = "angle"
    sources = ("CLM2022auto",)
    needs_handedness = True
    leaders = 2

    def __init__(
        self, target: TargetFormation, first_follower: str = "stationary", own_gains: Real | None = None
    ) -> None:
        if first_follower not in EDGE_LAWS:
            raise ValueError(f"first_follower must be one of {', '.join(EDGE_LAWS)}, got {first_follower!r}")
        self.gains = follower_gains(target) if own_gains is None else follower_gains(target) * own_gains[:, None]
        self.needs_compass = first_follower not in COMPASS_FREE
        self._stationary = first_follower == "stationary"
        self._first_follower = EDGE_LAWS[first_follower]
        self._n = target.graph.n

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, each in its agent's own frame.

        Args:
            relative: (..., 2n - 3, 2) relative positions, metres, each in its observer's frame, in the row order of
                :attr:`SensingGraph.edges`.
            compass: (..., n, 2) direction of the common x axis in each agent's frame; read by the first follower
                alone, and only if :attr:`needs_compass`.
            delta: (..., 2) commanded displacement of agent 2 from agent 1, metres, in the common frame; unused by a
                stationary first follower.
        """
        e = as_complex(relative)
        batch = e.shape[:-1]
        u = np.zeros((*batch, self._n), dtype=np.complex128)
        pairs = e[..., 1:].reshape(*batch, -1, 2) * self.gains
        np.add(pairs[..., 0], pairs[..., 1], out=u[..., agents.FIRST_ORDINARY :])
        if not self._stationary:
            u[..., agents.FIRST_FOLLOWER] = self._first_follower(-e[..., 0], self._local_delta(compass, delta))
        return as_vectors(u)

    def _local_delta(self, compass: Real | None, delta: Real | None) -> Complex:
        """The commanded displacement (...), complex, in the first follower's frame if its law needs that."""
        if delta is None:
            raise ValueError("delta is missing: a first follower that is not stationary needs it")
        if not self.needs_compass:
            return as_complex(delta)
        if compass is None:
            raise ValueError("compass is missing: the law of the first follower needs it")
        return as_complex(delta) * as_complex(compass)[..., agents.FIRST_FOLLOWER]


def follower_gains(target: TargetFormation) -> Complex:
    """(n - 2, 2) the gains -A_k^T A_i and -A_k^T A_j of eq. (u); they add up to sin^2 of the follower angle."""
    a_i, a_j, a_k = target.coefficients.T
    return np.stack([-np.conj(a_k) * a_i, -np.conj(a_k) * a_j], axis=1)
