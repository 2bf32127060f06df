"""What a choice of graph has to choose from: places, the edges that are allowed, and the graph that comes of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from formation.graph.sensing import Index, SensingGraph
from formation.plane import Real, as_complex
from formation.target import DEGENERATE_SINE, TargetFormation

Flags = NDArray[np.bool_]

NONDEGENERATE = DEGENERATE_SINE**2
"""sin^2 of a follower angle above which Assumption 2 holds."""


@dataclass(frozen=True, eq=False)
class Field:
    """Places of a target and who may sense whom.

    Attributes:
        positions: (n, 2) p*, metres, in any order of the agents.
        allowed: (n, n) whether the agent of the row may sense that of the column.
    """

    positions: Real
    allowed: Flags

    @classmethod
    def open(cls, positions: Real) -> Field:
        """Everybody may sense everybody."""
        n = len(positions)
        return cls(np.asarray(positions, dtype=np.float64), ~np.eye(n, dtype=bool))

    @classmethod
    def of_edges(cls, positions: Real, edges: Index) -> Field:
        """Only the edges (m, 2), rows (observer, observed), are allowed."""
        allowed = np.zeros((len(positions), len(positions)), dtype=bool)
        allowed[tuple(np.asarray(edges, dtype=np.intp).reshape(-1, 2).T)] = True
        np.fill_diagonal(allowed, False)
        return cls(np.asarray(positions, dtype=np.float64), allowed)

    @property
    def n(self) -> int:
        """Number of agents."""
        return len(self.positions)

    @cached_property
    def gaps(self) -> Real:
        """(n, n) distances, metres."""
        p = as_complex(self.positions)
        return np.abs(p[None, :] - p[:, None])

    @cached_property
    def directions(self) -> Real:
        """(n, n, 2) unit vectors from the agent of the row to that of the column; zero where they coincide."""
        e = self.positions[None, :] - self.positions[:, None]
        return e / np.where(self.gaps > 0.0, self.gaps, np.inf)[..., None]

    def within(self, reach: float) -> Field:
        """Without edges longer than ``reach`` metres."""
        return Field(self.positions, self.allowed & (self.gaps <= reach))

    def in_sight(self, radius: float) -> Field:
        """Without edges whose line of sight passes another agent, a disc of ``radius`` metres, in the target."""
        allowed = self.allowed.copy()
        p = as_complex(self.positions)
        for k in range(self.n):
            along = p - p[k]
            length = np.where(np.abs(along) > 0.0, np.abs(along), 1.0)
            local = along[None, :] * np.conj(along / length)[:, None]  # row: whom k looks at
            hides = (np.abs(local.imag) < radius) & (local.real > 0.0) & (local.real < np.abs(along)[:, None])
            hides[:, k] = False
            hides[np.arange(self.n), np.arange(self.n)] = False
            allowed[k] &= ~hides.any(axis=1)
        return Field(self.positions, allowed)


@dataclass(frozen=True, eq=False)
class Choice:
    """A leader-first-follower graph among the agents of a field.

    Attributes:
        leaders: rows of the leader and of the first follower.
        pairs: (n, 2) rows of each agent's two neighbours; -1 for the leaders, and for agents that were not reached.
        depth: (n,) 0 for the leader, 1 for the first follower, 1 + the deeper neighbour's for all others; -1 likewise.
    """

    leaders: tuple[int, int]
    pairs: Index
    depth: Index

    @property
    def whole(self) -> bool:
        """Whether every agent was reached."""
        return bool((self.depth >= 0).all())

    @property
    def unreached(self) -> Index:
        """Rows of the agents that were not."""
        return np.flatnonzero(self.depth < 0)

    @cached_property
    def order(self) -> Index:
        """(n,) rows in an order in which every agent comes after those that it senses, the leaders first."""
        rest = [row for row in np.argsort(self.depth, kind="stable").tolist() if row not in self.leaders]
        return np.array([*self.leaders, *rest], dtype=np.intp)

    def graph(self, numbers: Index | None = None) -> SensingGraph:
        """The sensing graph of the agents in :attr:`order`.

        Raises:
            ValueError: not every agent was reached.
        """
        if not self.whole:
            raise ValueError(f"agents in rows {self.unreached.tolist()} are not reached")
        place = np.empty(len(self.order), dtype=np.intp)
        place[self.order] = np.arange(len(self.order))
        return SensingGraph(place[self.pairs[self.order[2:]]])

    def target(self, positions: Real) -> TargetFormation:
        """The target formation of the agents in :attr:`order`, from places (n, 2) in the field's order, metres."""
        return TargetFormation(self.graph(), np.asarray(positions, dtype=np.float64)[self.order])
