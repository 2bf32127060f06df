"""Conditions on how a sensing graph grows, agent by agent: triangulated, persistent, ordered, for signed angles."""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.graph.edges import Index, edge_name, triangles
from formation.graph.rigidity import check_rank
from formation.plane import Complex, Real, as_complex

CONCYCLIC = 1e-3
"""1/m^2, times the square of the mean distance: from this determinant on, two angles fix a place."""


def triangulated(formation: Framework) -> None:
    """Undirected, and its triangles hang together: each but the first shares an edge with one before it."""
    graph = formation.graph
    _both_ways(graph.edges)
    found = triangles(graph.edges)
    if not len(found):
        raise ValueError("it has no triangle")
    reached, waiting = {*found[0].tolist()}, found[1:].tolist()
    edges = _sides(found[0])
    while joined := [t for t in waiting if _sides(t) & edges]:
        for t in joined:
            reached |= {*t}
            edges |= _sides(t)
        waiting = [t for t in waiting if t not in joined]
    if lost := sorted(set(range(graph.n)) - reached):
        raise ValueError(f"no chain of triangles, each sharing an edge with the next, reaches {agents.name(lost[0])}")


def triangulated_laman(formation: Framework) -> None:
    """Triangulated with as few edges as possible, 2n - 3: grown from one edge, each agent joins the ends of an edge."""
    triangulated(formation)
    graph = formation.graph
    if len(graph.edges) != 2 * (2 * graph.n - 3):
        raise ValueError(f"it has {len(graph.edges) // 2} edges, expected 2n - 3 = {2 * graph.n - 3}")


def minimally_persistent(formation: Framework) -> None:
    """Rigid with 2n - 3 edges if their directions are forgotten, and nobody senses more than two (Hendrickx et al.)."""
    graph = formation.graph
    degree = np.bincount(graph.edges[:, 0], minlength=graph.n)
    if (many := np.flatnonzero(degree > 2)).size:
        raise ValueError(f"{agents.name(many[0])} senses {degree[many[0]]} agents, expected at most 2")
    if len(graph.edges) != 2 * graph.n - 3:
        raise ValueError(f"it has {len(graph.edges)} edges, expected 2n - 3 = {2 * graph.n - 3}")
    check_rank(formation, "rigid", bearings=False)


def ordered(formation: Framework) -> None:
    """Agent 1 senses nobody, agent 2 at most agent 1, every other agent two or more agents with smaller numbers."""
    _before(formation, 2, agents.FIRST_ORDINARY)


def three_before(formation: Framework) -> None:
    """Every agent k >= 4 senses three or more agents with smaller numbers."""
    _before(formation, 3, 3)


def triangle(formation: Framework) -> None:
    """Three agents, every edge sensed from both its ends."""
    if formation.graph.n != 3:
        raise ValueError(f"expected 3 agents, got {formation.graph.n}")
    if len(formation.graph.edges) != 6:
        _both_ways(formation.graph.edges)
        raise ValueError("some two agents do not sense each other")


def signed_angles(formation: Framework) -> None:
    """Three agents sense each other, every other agent three that come before it and are not on one circle with it."""
    graph = formation.graph
    degree = np.bincount(graph.edges[:, 0], minlength=graph.n)
    if (odd := np.flatnonzero((degree != 2) & (degree != 3))).size:
        raise ValueError(f"{agents.name(odd[0])} senses {degree[odd[0]]} agents, expected 2 or 3")
    first = np.flatnonzero(degree == 2)
    sensed = {k: set(graph.edges[graph.edges[:, 0] == k, 1].tolist()) for k in range(graph.n)}
    if len(first) != 3 or any(sensed[k] != set(first.tolist()) - {k} for k in first.tolist()):
        raise ValueError("expected three agents that sense each other and nobody else")
    placed = set(first.tolist())
    while ready := [k for k in range(graph.n) if k not in placed and sensed[k] <= placed]:
        placed |= set(ready)
    if lost := sorted(set(range(graph.n)) - placed):
        raise ValueError(f"{agents.name(lost[0])} does not sense three agents that come before it: there is a cycle")
    p = as_complex(formation.positions)
    for k in range(graph.n):
        if degree[k] == 3:
            seen = sorted(sensed[k])
            size = float(np.abs(p[seen] - p[k]).mean())
            if abs(np.linalg.det(angle_slopes(p[seen] - p[k]))) * size**2 < CONCYCLIC:
                raise ValueError(f"{agents.name(k)} is on one circle with those that it senses")


def angle_slopes(rays: Complex) -> Real:
    """(2, 2) the derivative of the angles from ray 1 to 2 and from 2 to 3 by their vertex, 1/m; rays (3,) from it."""
    inward = 1j * rays / np.abs(rays) ** 2  # minus the derivative of a ray's direction by its vertex, as a vector
    slope = -(inward[1:] - inward[:-1])
    return np.stack([slope.real, slope.imag], axis=1)


def _before(formation: Framework, fewest: int, first: int) -> None:
    """Agents from row ``first`` on sense at least ``fewest`` agents, all of them with smaller numbers."""
    graph = formation.graph
    if (later := np.flatnonzero(graph.edges[:, 1] > graph.edges[:, 0])).size:
        k, i = graph.edges[later[0]]
        raise ValueError(f"{agents.name(k)} senses {agents.name(i)}; an agent may sense only agents before it")
    degree = np.bincount(graph.edges[:, 0], minlength=graph.n)
    if (few := np.flatnonzero((degree < fewest) & (np.arange(graph.n) >= first))).size:
        raise ValueError(f"{agents.name(few[0])} senses {degree[few[0]]} agents, expected at least {fewest}")


def _both_ways(edges: Index) -> None:
    known = {(k, i) for k, i in edges.tolist()}
    for k, i in sorted(known):
        if (i, k) not in known:
            raise ValueError(f"edge {edge_name((k, i))} is sensed from one end; {agents.name(i)} must sense it too")


def _sides(corners: Index | list[int]) -> set[tuple[int, int]]:
    i, j, k = (int(c) for c in corners)
    return {(i, j), (j, k), (i, k)}
