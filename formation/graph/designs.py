"""Sensing graphs of the kind that a law needs, built from a target."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import combinations
from math import comb
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.framework import Framework
from formation.graph.conditions import CONDITIONS
from formation.graph.constructions import angle_slopes
from formation.graph.directed import DirectedGraph
from formation.plane import Complex, as_complex

Real = NDArray[np.float64]

MOST_CHOICES = 200_000
"""Neighbours weighed for a graph for signed angles, all growths together: some seconds."""

NEAREST = 8
"""Placed agents among which an agent's three neighbours are sought; all of so few, the nearest of more."""


def design(condition: str, formation: Framework) -> Framework:
    """The target with a graph that fulfils a condition of :data:`CONDITIONS`; the given one where it already does.

    Args:
        condition: what the graph must be.
        formation: the target with the graph to start from.

    Raises:
        ValueError: nothing builds such a graph from that target.
    """
    try:
        CONDITIONS[condition](formation)
    except ValueError:
        pass
    else:
        return formation
    if condition not in DESIGNS:
        raise ValueError(f"nothing designs a graph that is {condition}")
    designed = Framework(DESIGNS[condition](formation), formation.positions)
    CONDITIONS[condition](designed)
    return designed


def both_ways(formation: Framework) -> DirectedGraph:
    """Every edge of the formation graph, sensed from both its ends; those of a triangulation where they do not do."""
    designed = DirectedGraph.both_ways(formation.graph.n, formation.graph.formation_edges)
    try:
        CONDITIONS["rigid"](Framework(designed, formation.positions))
    except ValueError:
        return laman(formation)
    return designed


def triangulation(formation: Framework) -> DirectedGraph:
    """The formation graph both ways if it is triangulated, as that of a leader-first-follower graph is."""
    designed = both_ways(formation)
    try:
        CONDITIONS["triangulated"](Framework(designed, formation.positions))
    except ValueError:
        return laman(formation)
    return designed


def laman(formation: Framework) -> DirectedGraph:
    """A triangulated Laman graph: each agent k >= 3 joins the edge of agents before it with which it is roundest."""
    p = as_complex(formation.positions)
    edges = [(agents.FIRST_FOLLOWER, agents.LEADER)]
    for k in range(agents.FIRST_ORDINARY, len(p)):
        corners = np.insert(p[np.array(edges)], 2, p[k], axis=1)
        j, i = edges[_roundness(corners).argmax()]
        edges += [(k, i), (k, j)]
    return DirectedGraph.both_ways(len(p), edges)


def pairs_before(formation: Framework) -> DirectedGraph:
    """Agent 2 senses 1, each later agent the two before it with which it is roundest."""
    p = as_complex(formation.positions)
    edges = [(agents.FIRST_FOLLOWER, agents.LEADER)]
    for k in range(agents.FIRST_ORDINARY, len(p)):
        pairs = list(combinations(range(k), 2))
        roundest = _roundness(np.insert(p[np.array(pairs)], 2, p[k], axis=1)).argmax()
        edges += [(k, i) for i in pairs[roundest]]
    return DirectedGraph(len(p), np.array(edges))


def chain(formation: Framework) -> DirectedGraph:
    """From agent 2 through 3, 4, ..., n to agent 1: every follower senses the one before it and the one after it."""
    n = formation.graph.n
    order = [agents.FIRST_FOLLOWER, *range(agents.FIRST_ORDINARY, n), agents.LEADER]
    edges = [(k, i) for before, k, after in zip(order, order[1:], order[2:], strict=False) for i in (before, after)]
    return DirectedGraph(n, np.array(edges))


def all_before(formation: Framework) -> DirectedGraph:
    """Every agent senses all agents before it."""
    n = formation.graph.n
    return DirectedGraph(n, np.array([(k, i) for k in range(n) for i in range(k)]))


def three_before(formation: Framework) -> DirectedGraph:
    """Every agent k >= 4 senses the three before it whose real weights are smallest."""
    return DirectedGraph(formation.graph.n, np.array(list(_threes(formation))))


def lateration(formation: Framework) -> DirectedGraph:
    """The first three agents sense each other, and each later one and its three neighbours."""
    edges = [(1, 0), (2, 0), (2, 1), *_threes(formation)]
    return DirectedGraph.both_ways(formation.graph.n, edges)


def signed_angles(formation: Framework) -> DirectedGraph:
    """Grown from the triple of agents from which the slowest follower is fastest; each takes its best three."""
    p = as_complex(formation.positions)
    triples = np.array(list(combinations(range(len(p)), 3)))
    starts = [tuple(t) for t in triples[_roundness(p[triples]) > 0.05].tolist()]
    if not starts:
        raise ValueError("all agents are collinear in the target")
    most = max(1, MOST_CHOICES // (comb(min(len(p), NEAREST), 3) * len(p) ** 2))
    grown = [_grow(p, start) for start in starts[:most]]
    _, edges = max(grown, key=lambda each: each[0])
    return DirectedGraph(len(p), np.array(edges))


def complete(formation: Framework) -> DirectedGraph:
    """All agents sense each other."""
    return DirectedGraph.both_ways(formation.graph.n, list(combinations(range(formation.graph.n), 2)))


def _roundness(corners: Complex) -> Real:
    """Twice the area of triangles (..., 3) over the square of the longest side; at most 0.87, 0 where one is flat."""
    a, b, c = np.moveaxis(corners, -1, 0)
    longest = np.max([np.hypot(side.real, side.imag) for side in (a - b, b - c, c - a)], axis=0)
    u, v = a - c, b - c
    area = np.abs(u.imag * v.real - u.real * v.imag)
    return np.divide(area, longest**2, out=np.zeros_like(area), where=longest > 0.0)


def _threes(formation: Framework) -> Iterable[tuple[int, int]]:
    p = as_complex(formation.positions)
    for k in range(3, len(p)):
        triples = np.array(list(combinations(range(k), 3)))
        options = triples[_roundness(p[triples]) > 1e-3]
        if not len(options):
            raise ValueError(f"all agents before {agents.name(k)} are collinear in the target")
        best = options[_weight(p[options] - p[k]).argmin()]
        yield from ((k, int(i)) for i in best)


def _weight(z: Complex) -> Real:
    """The sum of the sizes of the real weights by which agents see three others along rays (..., 3)."""
    system = np.stack([np.ones(z.shape), z.real, z.imag], axis=-2)
    return np.abs(np.linalg.solve(system, np.array([[1.0], [0.0], [0.0]]))[..., 0]).sum(axis=-1)


def _grow(p: Complex, start: tuple[int, ...]) -> tuple[float, list[tuple[int, int]]]:
    """The slowest follower's rate, and the edges, of the graph for signed angles that grows from three agents."""
    edges = [(k, i) for k in start for i in start if i != k]
    placed, slowest = list(start), np.inf
    while len(placed) < len(p):
        options = [
            (angle_rate(p[sorted(t)] - p[k]), k, t)
            for k in range(len(p))
            if k not in placed
            for t in combinations(_near(p, placed, k), 3)
        ]
        rate, k, best = max(options) if len(placed) > 3 else max(options, key=lambda each: each[0])
        slowest = min(slowest, rate)
        edges += [(k, i) for i in best]
        placed.append(k)
    return slowest, edges


def _near(p: Complex, placed: list[int], k: int) -> list[int]:
    """The agents of ``placed``, in their order, that are nearest to agent k."""
    if len(placed) <= NEAREST:
        return placed
    kept = set(sorted(placed, key=lambda i: abs(p[i] - p[k]))[:NEAREST])
    return [i for i in placed if i in kept]


def angle_rate(rays: Complex) -> float:
    """The rate, 1/s, at which an agent that sees three others along rays (3,), metres, returns by their bisectors."""
    turn = np.angle(rays[1:] * np.conj(rays[:-1]))
    slopes = angle_slopes(rays) * np.sign(turn)[:, None]
    b = rays / np.abs(rays)
    bisectors = b[1:] + b[:-1]
    loop = -np.stack([bisectors.real, bisectors.imag]) @ slopes
    return float(-np.linalg.eigvals(loop).real.max())


DESIGNS: Mapping[str, Callable[[Framework], DirectedGraph]] = MappingProxyType(
    {
        "leader-first-follower": pairs_before,
        "undirected": both_ways,
        "rooted": pairs_before,
        "two-rooted": chain,
        "rigid": both_ways,
        "bearing rigid": both_ways,
        "universally rigid": lateration,
        "triangulated": triangulation,
        "triangulated Laman": laman,
        "minimally persistent": pairs_before,
        "ordered": all_before,
        "three before": three_before,
        "signed angles": signed_angles,
        "triangle": complete,
    }
)
