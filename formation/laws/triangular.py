"""The triangular gradient: every agent descends the residuals of the linear constraints of all its triangles.

    u_h = -sum over the triangles (i, j, k) of h of A_h^T (A_i p_i + A_j p_j + A_k p_k)

Source      Chen, Sun 2022 (CLM2022tac), globally stabilizing triangularly angle rigid formations. Recalled, not checked
            against the text; the A are those of the paper's eq. (clm); tests hold the law against finite differences of
            half the sum of squared residuals
Graph       undirected, triangulated
Measures    relative positions in local frames of one sense of rotation
Proved      global exponential convergence to the shape, without a leader: the law is linear, and the end is the
            projection of the start on the shapes similar to the target
Fails       nothing keeps the scale: it shrinks, and from some starts nearly to nothing
"""

from __future__ import annotations

import numpy as np

from formation.constraint import constraint_coefficients, interior_angles
from formation.framework import Framework
from formation.laws.triangles import TriangleSum
from formation.plane import Complex, as_vectors


class TriangularLaw(TriangleSum):
    """Linear: each agent adds up constant complex multiples of what it measures."""

    name = "triangular"
    sources = ("CLM2022tac",)
    graph = "triangulated"
    needs_handedness = True
    leaders = 0

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        p = as_vectors(self._places)
        whole = self.corners[::3]  # i < j < k
        coefficients = constraint_coefficients(interior_angles(*(p[c] for c in whole.T)))
        turned = coefficients[:, [[0, 1, 2], [1, 2, 0], [2, 0, 1]]].reshape(-1, 3)  # A_h, A_a, A_b
        self._gain_a, self._gain_b = (-np.conj(turned[:, 0]) * turned[:, c] for c in (1, 2))

    def part(self, a: Complex, b: Complex) -> Complex:
        return self._gain_a * a + self._gain_b * b
