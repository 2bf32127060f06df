"""The target formation (G_f, p*): a shape, given by one configuration that has it (paper, Assumption 2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formation import agents
from formation.constraint import constraint_coefficients, interior_angles
from formation.framework import Framework
from formation.graph.sensing import SensingGraph
from formation.plane import Complex, Real, as_complex, as_vectors

DEGENERATE_SINE = 1e-6
"""A follower whose two outgoing edges are this close to collinear (sine of their angle) makes the target degenerate."""


@dataclass(frozen=True, eq=False)
class TargetFormation(Framework):
    """A strongly nondegenerate framework (G_f, p*).

    Attributes:
        graph: the sensing graph.
        positions: (n, 2) a configuration p* with the desired shape, metres; only its shape matters.

    Raises:
        ValueError: wrong shape, a number that is not finite, agents 1 and 2 in one place, or a follower that is
            collinear with its two neighbours (Assumption 2); the message names the triangle.
    """

    graph: SensingGraph

    def __post_init__(self) -> None:
        super().__post_init__()
        sine = np.abs(np.sin(self.follower_angles))
        degenerate = ~(sine > DEGENERATE_SINE)  # also true for NaN: two corners of the triangle coincide
        if (bad := np.flatnonzero(degenerate)).size:
            i, j, k = agents.numbers(self.graph.triangles[bad[0]])
            raise ValueError(
                f"Assumption 2: the triangle ({i}, {j}, {k}) is degenerate, agent {k} is collinear with its "
                f"neighbours {i} and {j}"
            )

    @cached_property
    def interior_angles(self) -> Real:
        """(n - 2, 3) interior signed angles at i, j and k of each follower's triangle (i, j, k), radians."""
        return interior_angles(*(self.positions[c] for c in self.graph.triangles.T))

    @property
    def follower_angles(self) -> Real:
        """(n - 2,) angle at each follower k = 3..n, radians: all that the convergence rate depends on (Theorem 1)."""
        return self.interior_angles[:, 2]

    @cached_property
    def coefficients(self) -> Complex:
        """(n - 2, 3) the matrices A_i, A_j, A_k of eq. (clm) of each follower's triangle, as complex numbers."""
        return constraint_coefficients(self.interior_angles)

    def residual(self, points: Real) -> Real:
        """(..., n - 2, 2) the constraint function f of Lemma 1, A_i p_i + A_j p_j + A_k p_k, of points (..., n, 2)."""
        corners = as_complex(points)[..., self.graph.triangles]
        return as_vectors((self.coefficients * corners).sum(axis=-1))
