"""Sensing graphs of any kind: directed edges, any number of neighbours.

The paper's law keeps its leader-first-follower type (:class:`formation.graph.sensing.SensingGraph`); the laws that it
is compared with name the graph that they need, and :mod:`formation.graph.conditions` checks it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from formation import agents
from formation.graph.edges import Index, corners, edge_name


class Graph(Protocol):
    """What measurements are taken along: agents, directed edges, and the pairs of edges that share an observer."""

    @property
    def n(self) -> int:
        """Number of agents."""

    @property
    def edges(self) -> Index:
        """(m, 2) rows (observer, observed), by observer; measurements follow this order everywhere."""

    @property
    def corners(self) -> Index:
        """(c, 2) rows of ``edges`` that share an observer, each pair once: where an angle or a ratio is measured."""

    @property
    def formation_edges(self) -> Index:
        """(f, 2) the edges that a drawing of the formation has; those of ``edges`` come first."""


@dataclass(frozen=True, eq=False)
class DirectedGraph:
    """A sensing graph without conditions: edge (k, i) means that agent k measures agent i.

    Attributes:
        n: number of agents.
        edges: (m, 2) rows (observer, observed), sorted.

    Raises:
        ValueError: an edge names no agent, leads from an agent to itself, or is given twice; the message names it.
    """

    n: int
    edges: Index

    def __post_init__(self) -> None:
        e = np.asarray(self.edges, dtype=np.intp).reshape(-1, 2)
        if (bad := np.flatnonzero(((e < 0) | (e >= self.n)).any(axis=1))).size:
            raise ValueError(f"edge {edge_name(e[bad[0]])} names an agent outside 1..{self.n}")
        if (bad := np.flatnonzero(e[:, 0] == e[:, 1])).size:
            raise ValueError(f"{agents.name(e[bad[0], 0])} senses itself")
        e = e[np.lexsort((e[:, 1], e[:, 0]))]
        if (bad := np.flatnonzero((e[1:] == e[:-1]).all(axis=1))).size:
            k, i = e[bad[0]]
            raise ValueError(f"{agents.name(k)} senses {agents.name(i)} twice")
        e.flags.writeable = False
        object.__setattr__(self, "edges", e)

    @classmethod
    def both_ways(cls, n: int, edges: ArrayLike) -> DirectedGraph:
        """The undirected graph of edges (m, 2): each is sensed from both its ends."""
        e = np.asarray(edges, dtype=np.intp).reshape(-1, 2)
        return cls(n, np.unique(np.concatenate([e, e[:, ::-1]]), axis=0))

    @cached_property
    def corners(self) -> Index:
        """(c, 2) rows of :attr:`edges` with one observer, the smaller observed agent first."""
        return corners(self.edges)

    @property
    def formation_edges(self) -> Index:
        """(m, 2) the edges themselves: nothing is added to what is sensed."""
        return self.edges

    def neighbours(self, k: int) -> Index:
        """Rows of the agents that the agent in row ``k`` senses, in ascending order."""
        return self.edges[self.edges[:, 0] == k, 1]
