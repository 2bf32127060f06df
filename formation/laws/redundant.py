"""Redundant neighbours: every follower uses whichever earlier agents it sees at the moment, two of them or all.

    u_k = a_k sum_m c_m (p_m - p_k),   sum_m c_m = 1,   sum_m c_m p*_m = p*_k,   of least norm among the m that are seen

Any two distinct earlier agents suffice, and then c is the paper's (1 - w_k, w_k); with fewer k holds still. The place
of rest is the same for every choice, and every choice gives a triangular matrix with one negative diagonal, so one
function sum eps^(2k) abs(p~_k)^2 falls for all of them: exponential convergence under arbitrary switching.

Source      ours: the paper's Remark 2, redundant sensing edges, put to use
Graph       ordered: agent 1 senses nobody, every agent k >= 3 two or more agents before it
Measures    relative positions in local frames of one sense of rotation
Proved      global exponential convergence under arbitrary loss of edges, while two are seen again and again
Fails       nothing known; more neighbours mean less noise and, for a scattered target, smaller gains
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import Law
from formation.plane import Complex, Real, as_complex, as_vectors

SINGULAR = 1e-12
"""Relative: two seen agents nearer to each other than this in the target count as one."""


class RedundantLaw(Law):
    """Agents 1 and 2 stand still.

    Args:
        formation: the target formation.
        rate: a_k of every follower, 1/s.

    Raises:
        ValueError: the rate is not positive.
    """

    name = "redundant"
    graph = "ordered"
    needs_handedness = True
    leaders = 2

    def __init__(self, formation: Framework, rate: float = 0.5) -> None:
        super().__init__(formation)
        if not rate > 0.0:
            raise ValueError(f"rate must be positive, got {rate:g} 1/s")
        self._rate = rate
        self._following = self._observer >= agents.FIRST_ORDINARY

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres; NaN where an edge is lost."""
        e = as_complex(relative)
        seen = (np.isfinite(e) & self._following).astype(np.float64)
        u = self._by_agent(self.weights(seen) * np.where(seen > 0.0, e, 0.0))
        return as_vectors(self._rate * u)

    def weights(self, seen: Real) -> Complex:
        """(..., m) the c of each edge, from 1 for each edge (..., m) that is seen and 0 for the others.

        With z_m = p*_m - p*_k the conditions are sum c = 1 and sum c z = 0; least norm: c = seen (a + b conj(z)).
        """
        z = -self._desired
        count = self._by_agent(seen.astype(np.complex128)).real
        first = self._by_agent(seen * z)
        second = self._by_agent((seen * np.abs(z) ** 2).astype(np.complex128)).real
        determinant = count * second - np.abs(first) ** 2
        good = determinant > SINGULAR * np.maximum(count * second, np.finfo(float).tiny)
        scale = np.where(good, 1.0 / np.where(good, determinant, 1.0), 0.0)
        a, b = second * scale, -first * scale
        return seen * (a[..., self._observer] + b[..., self._observer] * np.conj(z))
