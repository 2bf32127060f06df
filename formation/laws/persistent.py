"""Minimally persistent formations: every follower heads for the nearer crossing of two circles about its neighbours.

    u_k = t_k - p_k,   t_k the crossing, nearest to p_k, of the circles about p_i and p_j with the radii d_ki and d_kj

Where the circles do not cross, t_k is the point of the line through both centres that has one power to both circles.
The first follower heads for the nearest point of the circle about the leader.

Source      Yu, Anderson, Dasgupta, Fidan 2009 (ycb2009), leader-first-follower; Summers, Yu, Dasgupta, Anderson 2011
            (ycb2011), with cycles. Recalled, not checked against the texts; the gain matrix K_k is the unit matrix
Graph       minimally persistent: here leader-first-follower, so the cycles of ycb2011 are not covered
Measures    relative positions in any local frame, mirrored ones too
Proved      local exponential convergence
Fails       mirrored triangles; jumps from one crossing to the other on the line through the neighbours
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import SCALE, SHAPE, Law
from formation.plane import Real, as_complex, as_vectors


class PersistentLaw(Law):
    """The law on a leader-first-follower graph."""

    name = "persistent"
    sources = ("ycb2009", "ycb2011")
    fixes = (SHAPE, SCALE)
    steers = frozenset({SCALE})

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        self._pairs = formation.graph.corners

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres."""
        e, radius = as_complex(relative), np.abs(self._scaled(delta))
        u = np.zeros((*e.shape[:-1], self._n), dtype=np.complex128)
        u[..., agents.FIRST_FOLLOWER] = e[..., 0] * (1.0 - radius[..., 0] / np.abs(e[..., 0]))
        i, j = self._pairs.T
        base = e[..., j] - e[..., i]
        length = np.abs(base)
        along = (radius[..., i] ** 2 - radius[..., j] ** 2 + length**2) / (2.0 * length)
        across = np.sqrt(np.maximum(radius[..., i] ** 2 - along**2, 0.0))
        unit = base / length
        foot = e[..., i] + along * unit
        side = np.where((np.conj(1j * unit) * foot).real > 0.0, -1.0, 1.0)  # towards k, which is at 0
        u[..., agents.FIRST_ORDINARY :] = foot + side * across * 1j * unit
        return as_vectors(u)
