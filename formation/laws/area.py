"""Distances and signed areas: the sign of a triangle's area tells it from its mirror image.

Directed, each follower k with its two neighbours i < j:

    u_k = -sum_{m in (i, j)} (abs(e_km)^2 - d_km^2) e_km - K (S - S*) J (p_j - p_i),   e_km = p_k - p_m
    S = the cross product of p_j - p_i and p_k - p_i, J a quarter turn; u_2 = the distance law

Undirected, u = -gradient of 1/4 sum over the edges (abs(e)^2 - d^2)^2 + K/2 sum over the triangles (S - S*)^2.

Source      the family of Kwon, Sun, Anderson, Ahn (kwon2020hybrid), arXiv 1912.12952: the abstract was seen, which says
            distances and signed constraints, gradient, exponential convergence near the target; formulas not checked
            against the text; tests hold them against finite differences
Graph       leader-first-follower; or undirected and triangulated
Measures    relative positions in local frames of one sense of rotation
Proved      local exponential convergence; no ambiguity under the signed Henneberg construction (abstract)
Fails       the scale is fixed; a small K leaves wrong places of rest
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import SCALE, SHAPE, Law
from formation.laws.first_follower import distance
from formation.laws.triangles import TriangleSum
from formation.plane import Complex, Real, as_complex, as_vectors


class AreaLaw(Law):
    """The law on a leader-first-follower graph.

    Args:
        formation: the target formation.
        gain: K, 1/(m^2 s).
    """

    name = "area"
    sources = ("kwon2020hybrid",)
    needs_handedness = True
    fixes = (SHAPE, SCALE)
    steers = frozenset({SCALE})

    def __init__(self, formation: Framework, gain: float = 1.0) -> None:
        super().__init__(formation)
        self._gain = gain
        self._pairs = formation.graph.corners
        self._areas = _area(*np.moveaxis(-self._desired[self._pairs], -1, 0))

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres."""
        e, desired = as_complex(relative), self._scaled(delta)
        u = self._by_agent(distance(-e, desired))
        to_i, to_j = e[..., self._pairs[:, 0]], e[..., self._pairs[:, 1]]
        grown = np.abs(desired[..., 0] / self._desired[0])[..., None] ** 2
        error = _area(to_i, to_j) - grown * self._areas
        u[..., agents.FIRST_ORDINARY :] -= self._gain * error * 1j * (to_j - to_i)
        return as_vectors(u)


class UndirectedAreaLaw(TriangleSum):
    """The gradient law.

    Args:
        formation: the target formation.
        gain: K, 1/(m^2 s).
    """

    name = "area-undirected"
    sources = ("kwon2020hybrid",)
    graph = "triangulated"
    needs_handedness = True
    fixes = (SHAPE, SCALE)
    leaders: ClassVar[int] = 0

    def __init__(self, formation: Framework, gain: float = 1.0) -> None:
        super().__init__(formation)
        self._gain = gain
        self._areas = _turn(self._a, self._b)

    def part(self, a: Complex, b: Complex) -> Complex:
        return -self._gain * (_turn(a, b) - self._areas) * 1j * (b - a)

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres."""
        e = as_complex(relative)
        return as_vectors(self._in_triangles(e) + self._by_agent(distance(-e, self._desired)))


def _turn(a: Complex, b: Complex) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """The cross product of a and b: twice the signed area of the triangle 0, a, b."""
    return (np.conj(a) * b).imag


def _area(to_i: Complex, to_j: Complex) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """The cross product of p_j - p_i and p_k - p_i, from what k measures."""
    return _turn(to_j - to_i, -to_i)
