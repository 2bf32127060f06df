"""Signed angles by bearings alone: every agent moves along the bisectors of the angles that it controls.

    u_k = -sum over its angles (alpha_k(a, b) - alpha*_k(a, b)) (b_ka + b_kb)

Three agents that see each other control one angle each; every other agent sees three earlier ones, i, j, l, and
controls alpha(k; i, j) and alpha(k; j, l). Angles are signed, in [0, 2 pi), each pair taken in the order that makes its
target smaller than pi.

Source      Chen, Cao, Li 2020 (CLM2020tac), arXiv 1908.01542: the abstract was seen (signed angles, no other
            measurements, local); the formula is recalled, not checked against the text
Graph       "signed angles": one triangle that is sensed both ways, three earlier agents for every other
Measures    bearings in local frames of one sense of rotation
Proved      local exponential convergence, if no agent is concyclic with the three that it sees
Fails       from random starts nearly always, a little less with the error wrapped to (-pi, pi]
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from formation.angles import TURN, wrap
from formation.framework import Framework
from formation.laws.base import Law
from formation.measurements import BEARING
from formation.plane import Real, as_complex, as_vectors


class BisectorLaw(Law):
    """No leader: all agents move.

    Args:
        formation: the target formation.
        wrapped: 1 to wrap the error to (-pi, pi], 0 to take the difference of two angles in [0, 2 pi) as it is.

    Attributes:
        corners: (s, 3) rows (k, a, b): an agent, and the two others between which it controls an angle.
    """

    name = "bisector"
    sources = ("CLM2020tac",)
    graph = "signed angles"
    measures = (BEARING,)
    needs_handedness = True
    leaders = 0

    def __init__(self, formation: Framework, wrapped: float = 0.0) -> None:
        super().__init__(formation)
        pairs: list[tuple[int, int]] = []
        for k in range(self._n):
            mine = np.flatnonzero(self._observer == k).tolist()
            pairs += pairwise(mine)
        corners = np.array(pairs, dtype=np.intp)
        towards = -self._desired
        turn = np.mod(np.angle(towards[corners[:, 1]] * np.conj(towards[corners[:, 0]])), TURN)
        corners[turn > np.pi] = corners[turn > np.pi][:, ::-1]
        self._first, self._second = corners.T
        self.corners = np.column_stack([self._observer[corners[:, 0]], self._observed[corners]])
        self._wanted = np.minimum(turn, TURN - turn)
        self._wrapped = bool(wrapped)
        self._at = np.equal.outer(self._observer[self._first], np.arange(self._n)).astype(np.float64)

    def __call__(self, bearing: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from bearings (..., m, 2)."""
        b = as_complex(bearing)
        first, second = b[..., self._first], b[..., self._second]
        error = np.mod(np.angle(second * np.conj(first)), TURN) - self._wanted
        if self._wrapped:
            error = wrap(error)
        terms = error * (first + second)
        u = np.zeros((*terms.shape[:-1], self._n), dtype=np.complex128)
        for k in range(self._n):
            u[..., k] = -terms[..., self._at[:, k] > 0.0].sum(axis=-1)
        return as_vectors(u)
