"""Sensing graphs of the kind that a law needs, built from a target."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from formation.framework import Framework
from formation.graph.conditions import CONDITIONS
from formation.graph.directed import DirectedGraph


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
    """Every edge of the formation graph, sensed from both its ends."""
    return DirectedGraph.both_ways(formation.graph.n, formation.graph.formation_edges)


DESIGNS: Mapping[str, Callable[[Framework], DirectedGraph]] = MappingProxyType(
    {"undirected": both_ways, "rigid": both_ways, "bearing rigid": both_ways}
)
