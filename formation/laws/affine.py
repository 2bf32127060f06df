"""Affine formations: every follower keeps real weights of three neighbours, and the formation any affine image.

    u_k = sum_m c_km (p_m - p_k),   sum_m c_km = 1,   sum_m c_km p*_m = p*_k,   c real, of least norm

Undirected, u_k = -sum_m s_km (p_k - p_m) with an equilibrium stress s whose matrix has rank n - 3 and no negative mode.

Source      Lin, Wang, Chen, Fu, Han 2016 (Lin2016); Zhao 2018 (Lin2018). Recalled, not checked against the texts
Graph       every agent k >= 4 senses three agents before it; or undirected and universally rigid
Measures    relative positions in any local frame, mirrored ones too
Proved      global exponential convergence to the affine image of the target that the three leaders give
Fails       three agents do not stand in the target's triangle by themselves: from random starts an affine image, not
            the shape, is reached
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.graph.stress import equilibrium_stress
from formation.laws.base import Law
from formation.plane import Real, as_complex, as_vectors

LEADERS = 3


class AffineLaw(Law):
    """Agents 1, 2 and 3 stand still."""

    name = "affine"
    sources = ("Lin2016", "Lin2018")
    graph = "three before"
    fixes: ClassVar[tuple[str, ...]] = ("affine image",)
    leaders = LEADERS

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        self._weights = self._real_weights(formation)

    def _real_weights(self, formation: Framework) -> Real:
        weights = np.zeros(len(self._observer))
        for k in range(LEADERS, self._n):
            mine = np.flatnonzero(self._observer == k)
            z = -self._desired[mine]
            conditions = np.stack([np.ones(len(mine)), z.real, z.imag])
            if np.linalg.matrix_rank(conditions) < len(conditions):
                raise ValueError(f"the neighbours of {agents.name(k)} are collinear in the target")
            weights[mine] = np.linalg.pinv(conditions) @ np.array([1.0, 0.0, 0.0])
        return weights

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres."""
        return as_vectors(self._by_agent(self._weights * as_complex(relative)))


class UndirectedAffineLaw(AffineLaw):
    """The law of an equilibrium stress; all agents but the leaders move."""

    name = "affine-undirected"
    graph = "universally rigid"

    def _real_weights(self, formation: Framework) -> Real:
        weights = equilibrium_stress(formation)
        weights[self._observer < LEADERS] = 0.0
        return weights
