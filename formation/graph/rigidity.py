"""Rank conditions of a framework at p*.

The rows of a rigidity matrix, one for each undirected edge, must leave free what the kind of constraint always leaves
free, and nothing else.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.graph.edges import Index
from formation.plane import Real

RANK = 1e-9
"""Relative to the largest: a smaller singular value counts as zero."""


def undirected_pairs(edges: Index) -> Index:
    """(u, 2) the undirected edges, each once, the smaller row first."""
    return np.unique(np.sort(edges, axis=1), axis=0)


def rigidity_matrix(formation: Framework, bearings: bool = False) -> Real:
    """(u, 2n) derivative of the edges' distances (or bearings) by the places, each row divided by the edge's length."""
    pairs = undirected_pairs(formation.graph.edges)
    p = formation.positions
    direction = p[pairs[:, 1]] - p[pairs[:, 0]]
    direction = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    if bearings:
        direction = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    matrix = np.zeros((len(pairs), formation.graph.n, 2))
    rows = np.arange(len(pairs))
    matrix[rows, pairs[:, 1]] = direction
    matrix[rows, pairs[:, 0]] = -direction
    return matrix.reshape(len(pairs), -1)


def check_rank(formation: Framework, word: str, bearings: bool) -> None:
    """Whether the constraints along the edges leave nothing free but what all such constraints do."""
    n = formation.graph.n
    _, values, directions = np.linalg.svd(rigidity_matrix(formation, bearings))
    rank = int((values > RANK * values.max(initial=0.0)).sum())
    if rank < 2 * n - 3:
        loose = _loosest(formation, directions[rank:], bearings)
        raise ValueError(
            f"the framework is not {word}: {rank} of {2 * n - 3} constraints are independent, {agents.name(loose)} "
            "can move against the others"
        )


def _loosest(formation: Framework, free: Real, bearings: bool) -> int:
    """The agent that moves most in the free motions once the trivial ones are taken out."""
    p = formation.positions - formation.positions.mean(axis=0)
    turn = p if bearings else np.stack([-p[:, 1], p[:, 0]], axis=1)
    ones = np.ones(len(p))
    trivial = np.stack([np.kron(ones, [1.0, 0.0]), np.kron(ones, [0.0, 1.0]), turn.ravel()], axis=1)
    basis, _ = np.linalg.qr(trivial)
    rest = free - (free @ basis) @ basis.T
    moved = np.linalg.norm(rest.reshape(len(free), -1, 2), axis=2)
    return int(moved.max(axis=0).argmax())
