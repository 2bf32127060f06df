"""The feed-forward that makes the angle law exact on a formation that scales and turns.

Where delta changes, eq. (man) lags behind: at 0.2 rad/s the paper's shape is a quarter off. Told the one complex
number mu = delta'/delta = sigma + i omega, each agent adds what the scaling and turning formation needs of it,

    u_1 += 0,      u_2 += mu e_12,      u_k += mu f_k (e_kj - e_ki),      f_k = z_k / (z_j - z_i),

with z_k = (p*_k - p*_1) / (p*_2 - p*_1), e_12 = p_2 - p_1 and e_kj - e_ki = p_j - p_i. In the shape p_k - p_1 =
z_k delta this is z_k mu delta = z_k delta', exactly the velocity that the place of agent k has. No follower's term
depends on p_k, so the rates stay those of the law; all turn with the frame in which they are measured, so mu needs no
compass.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.target import TargetFormation


def places(target: Framework) -> Complex:
    """(n,) z_k: where each agent is in the frame in which agent 1 is at 0 and agent 2 at 1."""
    p = as_complex(target.positions)
    leader, first = p[: agents.FIRST_ORDINARY]
    return (p - leader) / (first - leader)


def shares(target: TargetFormation) -> Complex:
    """(n - 2,) f_k = z_k / (z_j - z_i) of the followers."""
    z = places(target)
    z_i, z_j, z_k = z[target.graph.triangles].T
    return z_k / (z_j - z_i)


class FeedForward:
    """What each agent adds to the angle law's velocity, from the relative positions that the law measures anyway."""

    def __init__(self, target: TargetFormation) -> None:
        self._shares = shares(target)
        self._n = target.graph.n

    def __call__(self, relative: Real, rate: complex) -> Real:
        """Velocities (..., n, 2), m/s, each in its agent's own frame.

        Args:
            relative: (..., 2n - 3, 2) relative positions as for :class:`~formation.laws.angle.AngleLaw`, metres.
            rate: mu, 1/s.
        """
        e = as_complex(relative)
        u = np.zeros((*e.shape[:-1], self._n), dtype=np.complex128)
        u[..., agents.FIRST_FOLLOWER] = -rate * e[..., 0]
        pairs = e[..., 1:].reshape(*e.shape[:-1], -1, 2)
        u[..., agents.FIRST_ORDINARY :] = rate * self._shares * (pairs[..., 1] - pairs[..., 0])
        return as_vectors(u)
