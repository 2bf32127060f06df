"""Laws for three agents that see each other, with unsigned constraints.

Angles only:   u_v = -(alpha_v - alpha*_v) (b_va + b_vb)
Mixed:         -gradient of 1/4 sum (abs(e)^2 - d^2)^2 over the edges (1, 2), (1, 3), plus 1/2 (cos alpha_1 - cos*)^2

Source      Basiri, Bishop, Jensfelt 2010 (basiri2010); Bishop, Summers, Anderson 2012 (bishop2012), of the kind of
            which the mixed law is. Both recalled, not checked against the texts
Graph       three agents, every edge sensed from both its ends
Measures    bearings, or relative positions, in any local frame, mirrored ones too
Proved      convergence up to a mirror image from almost everywhere
Fails       the mirror image is as good: half of all random starts end in it, those that start mirrored
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import SCALE, SHAPE, Law
from formation.laws.first_follower import distance
from formation.measurements import BEARING
from formation.plane import Complex, Real, as_complex, as_vectors


class BasiriLaw(Law):
    """Angles only."""

    name = "triangle-angles"
    sources = ("basiri2010",)
    graph = "triangle"
    measures = (BEARING,)
    leaders = 0

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        self._wanted = _angle(*_rays(self._desired))

    def __call__(self, bearing: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., 3, 2), m/s, from bearings (..., 6, 2)."""
        a, b = _rays(as_complex(bearing))
        return as_vectors(-(_angle(a, b) - self._wanted) * (a + b))


class BishopLaw(Law):
    """Two distances and the angle between them."""

    name = "triangle-mixed"
    sources = ("bishop2012",)
    graph = "triangle"
    fixes = (SHAPE, SCALE)
    leaders = 0

    def __init__(self, formation: Framework) -> None:
        super().__init__(formation)
        a, b = _rays(-self._desired)
        self._cosine = float(_cosine(a, b)[agents.LEADER])

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., 3, 2), m/s, from relative positions (..., 6, 2), metres."""
        e = as_complex(relative)
        pulls = distance(-e, self._desired)
        a, b = _rays(e)  # of agent 1: to 2 and 3; of 2: to 1 and 3; of 3: to 1 and 2
        u = np.zeros((*e.shape[:-1], self._n), dtype=np.complex128)
        to_2, to_3 = a[..., 0], b[..., 0]
        u[..., 0] = pulls[..., 0] + pulls[..., 1]
        u[..., 0] += (_cosine(to_2, to_3) - self._cosine) * (_slope(to_2, to_3) + _slope(to_3, to_2))
        for k in (1, 2):
            own, far = -a[..., k], b[..., k] - a[..., k]  # from agent 1: to k itself, to the other
            u[..., k] = pulls[..., 2 * k] - (_cosine(own, far) - self._cosine) * _slope(own, far)
        return as_vectors(u)


def _rays(e: Complex) -> tuple[Complex, Complex]:
    """What each agent sees of the other two, (..., 3) each, the smaller number first."""
    return e[..., ::2], e[..., 1::2]


def _cosine(x: Complex, y: Complex) -> Real:
    return (np.conj(x) * y).real / (np.abs(x) * np.abs(y))


def _angle(x: Complex, y: Complex) -> Real:
    """The angle between two rays, in [0, pi]; from sine and cosine, since the arc cosine is inexact near 0 and pi."""
    turn = np.conj(x) * y
    return np.arctan2(np.abs(turn.imag), turn.real)


def _slope(x: Complex, y: Complex) -> Complex:
    u, v = x / np.abs(x), y / np.abs(y)
    return (v - u * (np.conj(u) * v).real) / np.abs(x)
