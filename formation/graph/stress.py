"""Equilibrium stresses: real weights s_ki = s_ik of undirected edges with sum_i s_ki (p*_k - p*_i) = 0 at every agent.

A framework in general position is universally rigid, that is, determined up to congruence in every dimension by its
distances, exactly if some stress matrix has rank n - 3 and no negative mode (Gortler, Thurston 2014; not checked
against the text). Then affine images are all that the stress leaves free.
"""

from __future__ import annotations

import numpy as np

from formation.framework import Framework
from formation.graph.edges import Index
from formation.plane import Real

ROUNDS = 4000
"""Alternating projections after which no stress counts as found."""

FLAT = 1e-9
"""Relative to the largest: a smaller singular value counts as zero."""


def equilibrium_stress(formation: Framework) -> Real:
    """(m,) a stress of the edges, directed both ways, whose matrix has rank n - 3, its smallest other mode 1 1/s.

    The matrices of stresses are a linear space; those whose modes are at least 1 where they may be are a convex set.
    Projections on one and the other in turns end in both, if anything is in both.

    Raises:
        ValueError: none was found.
    """
    edges, n = formation.graph.edges, formation.graph.n
    pairs = np.unique(np.sort(edges, axis=1), axis=0)
    placed = np.concatenate([formation.positions, np.ones((n, 1))], axis=1)
    basis, _ = np.linalg.qr(placed, mode="complete")
    rest = basis[:, placed.shape[1] :]
    stresses = _stresses(formation.positions, pairs)
    matrices = np.array([rest.T @ _matrix(stress, pairs, n) @ rest for stress in stresses.T])
    if not len(matrices) or n <= placed.shape[1]:
        raise ValueError("the framework is not universally rigid: its edges carry no stress")
    flat = matrices.reshape(len(matrices), -1)
    back = np.linalg.pinv(flat.T)
    wanted = np.eye(n - placed.shape[1])
    for _ in range(ROUNDS):
        amounts = back @ wanted.ravel()
        found = (amounts @ flat).reshape(wanted.shape)
        values, directions = np.linalg.eigh(found)
        if values[0] > 0.5:
            chosen = stresses @ amounts / values[0]
            place = {pair: row for row, pair in enumerate(map(tuple, pairs.tolist()))}
            rows = [place[k, i] if k < i else place[i, k] for k, i in edges.tolist()]
            return np.asarray(chosen[rows], dtype=np.float64)
        wanted = (directions * np.maximum(values, 1.0)) @ directions.T
    raise ValueError("the framework is not universally rigid: no stress without negative modes was found")


def _stresses(positions: Real, pairs: Index) -> Real:
    """(u, d) a basis of the stresses of undirected edges (u, 2)."""
    equilibrium = np.zeros((len(positions), 2, len(pairs)))
    rows = np.arange(len(pairs))
    along = positions[pairs[:, 1]] - positions[pairs[:, 0]]
    equilibrium[pairs[:, 0], :, rows] = along
    equilibrium[pairs[:, 1], :, rows] = -along
    _, values, directions = np.linalg.svd(equilibrium.reshape(-1, len(pairs)))
    rank = int((values > FLAT * values.max()).sum())
    return directions[rank:].T


def _matrix(stress: Real, pairs: Index, n: int) -> Real:
    matrix = np.zeros((n, n))
    i, j = pairs.T
    matrix[i, j] = matrix[j, i] = -stress
    return matrix - np.diag(matrix.sum(axis=1))
