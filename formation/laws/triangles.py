"""What laws on triangulated graphs share: each agent sees the two others of each of its triangles."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from formation.framework import Framework
from formation.graph.edges import rows_of, triangles
from formation.laws.base import Law
from formation.plane import Complex, Real, as_complex, as_vectors

TURNED = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])
"""The corners (h, a, b) of a triangle, seen from each: the order h, a, b turns the same way for all three."""


class TriangleSum(Law):
    """u_h = sum over the triangles (h, a, b) of h of a function of a - h and b - h, which are measured by h.

    Attributes:
        corners: (s, 3) all (h, a, b), three for each triangle (i, j, k), i < j < k: (i, j, k), (j, k, i), (k, i, j).
    """

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        edges = formation.graph.edges
        self.corners = triangles(edges)[:, TURNED].reshape(-1, 3)
        self._to_a, self._to_b = (rows_of(edges, self.corners[:, [0, c]]) for c in (1, 2))
        h, a, b = self._places[self.corners].T
        self._a, self._b = a - h, b - h

    @abstractmethod
    def part(self, a: Complex, b: Complex) -> Complex:
        """The part (..., s) of u_h that each of :attr:`corners` gives, from a - h and b - h (..., s), metres."""

    def _in_triangles(self, e: Complex) -> Complex:
        u = np.zeros((*e.shape[:-1], self._n), dtype=np.complex128)
        parts = self.part(e[..., self._to_a], e[..., self._to_b])
        for h in range(self._n):
            mine = np.flatnonzero(self.corners[:, 0] == h)
            u[..., h] = parts[..., mine].sum(axis=-1)
        return u

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres, in any local frames."""
        return as_vectors(self._in_triangles(as_complex(relative)))
