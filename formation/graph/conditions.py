"""What a law may demand of its sensing graph, checked with the agent or the edge that breaks it.

Rank conditions are those of the framework at p*: the rows of a rigidity matrix, one for each undirected edge, must
leave free what the kind of constraint leaves free, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.graph.edges import Index, edge_name
from formation.graph.sensing import SensingGraph
from formation.plane import Real

RANK = 1e-9
"""Relative to the largest: a smaller singular value counts as zero."""


def leader_first_follower(formation: Framework) -> None:
    """Assumption 1 of the paper."""
    SensingGraph.from_edges(formation.graph.n, formation.graph.edges)


def undirected(formation: Framework) -> None:
    """Every edge is sensed from both its ends, and the graph is connected."""
    edges = formation.graph.edges
    known = {(int(k), int(i)) for k, i in edges}
    for k, i in known:
        if (i, k) not in known:
            raise ValueError(f"edge {edge_name((k, i))} is sensed from one end; {agents.name(i)} must sense it too")
    lost = np.flatnonzero(~reached(formation.graph.n, edges, {agents.LEADER}))
    if lost.size:
        raise ValueError(f"{agents.name(lost[0])} is not connected to {agents.name(agents.LEADER)}")


def rooted(formation: Framework) -> None:
    """A chain of sensing edges leads from every agent to the leader, which senses nobody."""
    graph = formation.graph
    lost = np.flatnonzero(~reached(graph.n, graph.edges, {agents.LEADER}))
    if lost.size:
        raise ValueError(f"no chain of sensing edges leads from {agents.name(lost[0])} to {agents.name(agents.LEADER)}")


def two_rooted(formation: Framework) -> None:
    """Two chains that share no agent lead from every other agent to agents 1 and 2 (Lin et al.: 2-reachable)."""
    graph = formation.graph
    roots = {agents.LEADER, agents.FIRST_FOLLOWER}
    for without in [None, *range(graph.n)]:
        edges = graph.edges if without is None else graph.edges[(graph.edges != without).all(axis=1)]
        found = reached(graph.n, edges, roots - {without})
        lost = [k for k in np.flatnonzero(~found).tolist() if k not in roots and k != without]
        if lost:
            gone = "" if without is None else f", none is left without {agents.name(without)}"
            raise ValueError(
                f"{agents.name(lost[0])} has no two separate chains of sensing edges to agents 1 and 2{gone}"
            )


def reached(n: int, edges: Index, roots: set[int]) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(n,) which agents a chain of sensing edges leads from, to one of the roots."""
    found = np.zeros(n, dtype=bool)
    found[list(roots)] = True
    while True:
        news = edges[found[edges[:, 1]] & ~found[edges[:, 0]], 0]
        if not news.size:
            return found
        found[news] = True


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


def rigid(formation: Framework) -> None:
    """Undirected, and the distances along the edges determine the framework near p* (infinitesimally)."""
    undirected(formation)
    _check_rank(formation, "rigid", bearings=False)


def bearing_rigid(formation: Framework) -> None:
    """Undirected, and the bearings along the edges determine the framework but for scale and place."""
    undirected(formation)
    _check_rank(formation, "bearing rigid", bearings=True)


def _check_rank(formation: Framework, word: str, bearings: bool) -> None:
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


CONDITIONS: Mapping[str, Callable[[Framework], None]] = MappingProxyType(
    {
        "any": lambda formation: None,
        "leader-first-follower": leader_first_follower,
        "undirected": undirected,
        "rooted": rooted,
        "two-rooted": two_rooted,
        "rigid": rigid,
        "bearing rigid": bearing_rigid,
    }
)
"""Each condition by the name that a law declares; each raises a ValueError that names what breaks it."""
