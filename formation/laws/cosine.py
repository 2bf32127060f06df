"""The cosine gradient: every agent descends the errors of the cosines of all angles of its triangles.

    u = -gradient of 1/2 sum over the corners (h; a, b) of (b_ha . b_hb - cosine*)^2

Source      Jing, Zhang, Lee, Wang 2019 (Jing2019), arXiv 1803.04276: the abstract was seen, the formula is the gradient
            of the function that it names, not checked against the text; tests hold it against finite differences
Graph       undirected, triangulated
Measures    relative positions in any local frame, mirrored ones too
Proved      local exponential convergence, up to a mirror image (abstract)
Fails       from random starts nearly always: wrong places of rest, mirrored triangles, creeping
"""

from __future__ import annotations

import numpy as np

from formation.framework import Framework
from formation.laws.triangles import TriangleSum
from formation.plane import Complex


class CosineLaw(TriangleSum):
    """Cosines do not tell an angle from its mirror image."""

    name = "cosine"
    sources = ("Jing2019",)
    graph = "triangulated"
    leaders = 0

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        self._wanted = tuple(_cosine(x, y) for x, y in ((self._a, self._b), (-self._a, self._b - self._a)))
        self._wanted_b = _cosine(-self._b, self._a - self._b)

    def part(self, a: Complex, b: Complex) -> Complex:
        at_h, at_a = self._wanted
        own = (_cosine(a, b) - at_h) * (_slope(a, b) + _slope(b, a))
        # The corners at a and at b: there h is the far end of the ray a -> h, and of b -> h.
        return (
            own
            - (_cosine(-a, b - a) - at_a) * _slope(-a, b - a)
            - (_cosine(-b, a - b) - self._wanted_b) * _slope(-b, a - b)
        )


def _cosine(x: Complex, y: Complex) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return (np.conj(x) * y).real / (np.abs(x) * np.abs(y))


def _slope(x: Complex, y: Complex) -> Complex:
    """The derivative of the cosine between x and y by x."""
    u, v = x / np.abs(x), y / np.abs(y)
    return (v - u * (np.conj(u) * v).real) / np.abs(x)
