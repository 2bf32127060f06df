"""What a law may demand of its sensing graph, checked with the agent or the edge that breaks it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.graph import constructions
from formation.graph.edges import Index, edge_name
from formation.graph.rigidity import check_rank
from formation.graph.sensing import SensingGraph
from formation.graph.stress import equilibrium_stress


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


def rigid(formation: Framework) -> None:
    """Undirected, and the distances along the edges determine the framework near p* (infinitesimally)."""
    undirected(formation)
    check_rank(formation, "rigid", bearings=False)


def bearing_rigid(formation: Framework) -> None:
    """Undirected, and the bearings along the edges determine the framework but for scale and place."""
    undirected(formation)
    check_rank(formation, "bearing rigid", bearings=True)


def universally_rigid(formation: Framework) -> None:
    """Undirected, with an equilibrium stress that leaves free the affine images of the framework and nothing else."""
    undirected(formation)
    equilibrium_stress(formation)


CONDITIONS: Mapping[str, Callable[[Framework], None]] = MappingProxyType(
    {
        "any": lambda formation: None,
        "leader-first-follower": leader_first_follower,
        "undirected": undirected,
        "rooted": rooted,
        "two-rooted": two_rooted,
        "rigid": rigid,
        "bearing rigid": bearing_rigid,
        "universally rigid": universally_rigid,
        "triangulated": constructions.triangulated,
        "triangulated Laman": constructions.triangulated_laman,
        "minimally persistent": constructions.minimally_persistent,
        "ordered": constructions.ordered,
        "three before": constructions.three_before,
        "signed angles": constructions.signed_angles,
        "triangle": constructions.triangle,
    }
)
"""Each condition by the name that a law declares; each raises a ValueError that names what breaks it."""
