"""Complex Laplacian: every follower keeps complex ratios of displacements, on any two-rooted graph, cycles included.

    u_k = D_k sum_m c_km (p_m - p_k),   sum_m c_km = 1,   sum_m c_km p*_m = p*_k,   least norm

With two neighbours c is (1 - w_k, w_k), as in eq. (u). On a graph with cycles the D_k have to be designed: with D = 1
some targets diverge. :func:`design_gains` looks for D_k = exp(i phi_k) that make every mode decay.

Source      Lin, Wang, Han, Fu 2014, complex Laplacian, two-rooted graphs, existence of stabilising gains
            (abstract seen); Lin2016 and Lin2018 are recalled as its sequels; the search for gains is ours
Graph       two-rooted: two separate chains of sensing edges lead from every follower to agents 1 and 2
Measures    relative positions in local frames of one sense of rotation
Proved      global exponential convergence, for generic targets and designed D
Fails       D needs the whole graph and target, before the run; special targets have none
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import Law
from formation.plane import Complex, Real, as_complex, as_vectors

DRAWS, FINALISTS = 4000, 4
"""Random gains that the search looks at, and how many of them it improves."""

ANGLES, NARROWEST = 9, 1e-3
"""Turns of one gain that are tried at once, and the smallest, radians."""

WANTED = 0.25
"""1/s; where the slowest mode is this fast with D = 1, nothing is designed."""


class LaplacianLaw(Law):
    """Agents 1 and 2 stand still.

    Args:
        formation: the target formation.
        designed: 1 for designed gains, 0 for D = 1.

    Attributes:
        gains: (n,) D_k; 1 for agents 1 and 2, which do not move.

    Raises:
        ValueError: an agent's neighbours do not determine its place, or no gains were found.
    """

    name = "laplacian"
    sources = ("Lin2016", "Lin2018")
    graph = "two-rooted"
    needs_handedness = True
    leaders = 2

    def __init__(self, formation: Framework, designed: float = 1.0) -> None:
        super().__init__(formation)
        self._weights = least_norm(-self._desired, self._observer, self._n)
        self._weights[self._observer < agents.FIRST_ORDINARY] = 0.0
        matrix = self.matrix()[agents.FIRST_ORDINARY :, agents.FIRST_ORDINARY :]
        followers = design_gains(matrix) if designed else np.ones(len(matrix), dtype=np.complex128)
        self.gains = np.concatenate([np.ones(agents.FIRST_ORDINARY, dtype=np.complex128), followers])

    def matrix(self) -> Complex:
        """(n, n) the closed loop with D = 1, 1/s."""
        matrix = np.zeros((self._n, self._n), dtype=np.complex128)
        matrix[self._observer, self._observed] = self._weights
        return matrix - np.diag(matrix.sum(axis=1))

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., m, 2), metres."""
        return as_vectors(self.gains * self._by_agent(self._weights * as_complex(relative)))


def least_norm(z: Complex, observer: np.ndarray[tuple[int], np.dtype[np.intp]], n: int) -> Complex:
    """(m,) complex c of each edge with sum c = 1 and sum c z = 0 over each agent's edges, of least norm.

    Args:
        z: (m,) p*_m - p*_k of each edge.
        observer: (m,) rows of the k.
        n: number of agents.

    Raises:
        ValueError: an agent k >= 3 has fewer than two neighbours.
    """
    c = np.zeros(len(z), dtype=np.complex128)
    for k in range(agents.FIRST_ORDINARY, n):
        mine = np.flatnonzero(observer == k)
        if len(mine) < 2:
            raise ValueError(f"{agents.name(k)} senses fewer than two agents")
        c[mine] = np.linalg.pinv(np.stack([np.ones(len(mine)), z[mine]])) @ np.array([1.0, 0.0])
    return c


def abscissa(matrix: Complex, gains: Complex) -> float:
    """The largest real part of the modes of diag(gains) matrix, 1/s."""
    return float(np.linalg.eigvals(gains[:, None] * matrix).real.max())


def design_gains(matrix: Complex) -> Complex:
    """(f,) unit complex gains D of followers that make diag(D) matrix stable; 1 where they need no design.

    A search: of many random directions the best few are improved, one agent after the other, by ever smaller turns.

    Raises:
        ValueError: none were found.
    """
    best = np.ones(len(matrix), dtype=np.complex128)
    if abscissa(matrix, best) < -WANTED:
        return best
    rng = np.random.default_rng(0)
    tried = np.exp(1j * rng.uniform(-np.pi, np.pi, (DRAWS, len(matrix))))
    slowest = np.linalg.eigvals(tried[:, :, None] * matrix).real.max(axis=1)
    improved = [_improve(matrix, tried[row]) for row in np.argsort(slowest)[:FINALISTS]]
    best = min(improved, key=lambda gains: abscissa(matrix, gains))
    if abscissa(matrix, best) >= 0.0:
        raise ValueError(f"no stabilising gains were found: the best leave a mode at {abscissa(matrix, best):+.3f} 1/s")
    return best


def _improve(matrix: Complex, gains: Complex) -> Complex:
    """Gains whose slowest mode is no slower, by turns of one agent's gain at a time."""
    width = 1.0
    while width > NARROWEST:
        before = abscissa(matrix, gains)
        for k in range(len(matrix)):
            turned = np.tile(gains, (ANGLES, 1))
            turned[:, k] *= np.exp(1j * np.linspace(-width, width, ANGLES))
            gains = turned[np.linalg.eigvals(turned[:, :, None] * matrix).real.max(axis=1).argmin()]
        if abscissa(matrix, gains) > before - NARROWEST:
            width /= 2.0
    return gains
