"""Displacement laws: every agent drives the displacements that it measures to those of the target.

    u_k = -sum_i (e_ki - e*_ki),   e_ki = p_k - p_i

Source      Ren, Beard, Atkins 2007; Oh, Park, Ahn 2015; the paper's kang2015. Recalled, not checked against the texts
Graph       a spanning tree of sensing edges rooted at one agent; or every edge sensed from both its ends
Measures    relative positions, with a compass
Proved      global exponential convergence to the target's shape, scale and orientation
Fails       with compass errors beta_k: on a leader-first-follower graph the formation is deformed and stands; sensed
            from both ends it drifts for ever, at abs(sum_k sum_j R(beta_k) e*_kj) / n (see :func:`drift`)
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from formation.framework import Framework
from formation.laws.base import ORIENTATION, SCALE, SHAPE
from formation.laws.edge_sum import EdgeSum
from formation.laws.first_follower import displacement
from formation.plane import Real, as_complex, as_vectors


class DisplacementLaw(EdgeSum):
    """The law on a leader-first-follower graph: the leader stands still."""

    name = "displacement"
    sources = ("kang2015",)
    needs_compass = True
    needs_handedness = True
    fixes = (SHAPE, SCALE, ORIENTATION)
    steers = frozenset({SCALE, ORIENTATION})
    edge_law = staticmethod(displacement)


class UndirectedDisplacementLaw(DisplacementLaw):
    """The law where every edge is sensed from both its ends: the centroid stands still."""

    name = "displacement-undirected"
    graph = "undirected"
    leaders: ClassVar[int] = 0


def drift(formation: Framework, compass_errors: ArrayLike) -> Real:
    """(..., 2) the velocity, m/s, at which the undirected law moves for ever with compass errors (..., n), radians.

    Agent k sees the target turned by beta_k. Summed over all agents the measured displacements cancel, edge by edge,
    whatever the places; the wanted ones do not, so the centroid moves at the mean of R(beta_k) e*_kj over all agents,
    from the first instant on, and in the end everybody moves with it.
    """
    k, i = formation.graph.edges.T
    p = as_complex(formation.positions)
    turned = np.exp(1j * np.asarray(compass_errors, dtype=np.float64))[..., k] * (p[k] - p[i])
    return as_vectors(turned.sum(axis=-1) / formation.graph.n)
