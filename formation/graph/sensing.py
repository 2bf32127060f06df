"""The sensing graph: who measures whom (paper, Section 2.1 and Assumption 1).

A directed edge (k, i) means that agent k measures the relative position of its neighbour i. A leader-first-follower
(LFF) graph is acyclic and minimal: agent 1 (the leader) senses nobody, agent 2 (the first follower) senses agent 1,
every later agent senses exactly two agents with smaller numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from formation import agents
from formation.graph.edges import Index as Index
from formation.graph.edges import corners


@dataclass(frozen=True, eq=False)
class SensingGraph:
    """A leader-first-follower sensing graph that satisfies Assumption 1.

    Attributes:
        neighbours: (n - 2, 2) array rows of the neighbours i < j of the followers k = 3..n, in the order of k.

    Raises:
        ValueError: a follower's neighbours are not two distinct agents with smaller numbers; the message names the
            agent and the clause of Assumption 1 that it breaks.
    """

    neighbours: Index

    def __post_init__(self) -> None:
        given = np.asarray(self.neighbours)
        if given.ndim != 2 or given.shape[1:] != (2,):
            raise ValueError(f"neighbours must have the shape (n - 2, 2), got {given.shape}")
        pairs = np.sort(given.astype(np.intp), axis=1)
        followers = np.arange(agents.FIRST_ORDINARY, agents.FIRST_ORDINARY + len(pairs))
        if (bad := np.flatnonzero(pairs[:, 0] < 0)).size:
            raise ValueError(
                f"{agents.name(followers[bad[0]])} senses agent {agents.number(pairs[bad[0], 0])}, "
                "agents are numbered from 1"
            )
        if (bad := np.flatnonzero(pairs[:, 1] >= followers)).size:
            k, j = followers[bad[0]], pairs[bad[0], 1]
            raise ValueError(
                f"Assumption 1, clause (ii): {agents.name(k)} senses {agents.name(j)}; "
                "an agent may sense only agents with smaller numbers"
            )
        if (bad := np.flatnonzero(pairs[:, 0] == pairs[:, 1])).size:
            raise ValueError(
                f"Assumption 1, clause (i): {agents.name(followers[bad[0]])} senses "
                f"{agents.name(pairs[bad[0], 0])} twice; a follower senses two distinct agents"
            )
        pairs.flags.writeable = False
        object.__setattr__(self, "neighbours", pairs)

    @classmethod
    def from_edges(cls, n: int, edges: ArrayLike) -> SensingGraph:
        """The graph with ``n`` agents and the sensing edges (m, 2) of rows (observer, observed), in any order.

        Raises:
            ValueError: an edge names no agent, or the edges break Assumption 1.
        """
        if n < 2:
            raise ValueError(f"a leader-first-follower graph has at least 2 agents, got {n}")
        e = np.asarray(edges, dtype=np.intp).reshape(-1, 2)
        if (bad := np.flatnonzero(((e < 0) | (e >= n)).any(axis=1))).size:
            k, i = agents.numbers(e[bad[0]])
            raise ValueError(f"edge ({k}, {i}) names an agent outside 1..{n}")
        if (bad := np.flatnonzero(e[:, 1] >= e[:, 0])).size:
            k, i = e[bad[0]]
            raise ValueError(
                f"Assumption 1, clause (ii): {agents.name(k)} senses {agents.name(i)}; "
                "an agent may sense only agents with smaller numbers"
            )
        required = np.minimum(np.arange(n), 2)
        degree = np.bincount(e[:, 0], minlength=n)
        if (bad := np.flatnonzero(degree != required)).size:
            k = int(bad[0])
            raise ValueError(
                f"Assumption 1, clause (i): {agents.name(k)} has {_count(int(degree[k]))}, expected {required[k]}"
            )
        ordered = e[np.argsort(e[:, 0], kind="stable")]
        return cls(ordered[1:, 1].reshape(-1, 2))

    @classmethod
    def random(cls, n: int, rng: np.random.Generator) -> SensingGraph:
        """A graph drawn uniformly: each follower senses two distinct agents among those before it.

        Raises:
            ValueError: ``n`` is smaller than 3.
        """
        if n < 3:
            raise ValueError(f"a random leader-first-follower graph needs at least 3 agents, got {n}")
        k = np.arange(agents.FIRST_ORDINARY, n)
        first = rng.integers(0, k)
        second = rng.integers(0, k - 1)
        return cls(np.stack([first, second + (second >= first)], axis=1))

    @property
    def n(self) -> int:
        """Number of agents."""
        return len(self.neighbours) + agents.FIRST_ORDINARY

    @cached_property
    def followers(self) -> Index:
        """(n - 2,) rows of the followers k = 3..n."""
        return np.arange(agents.FIRST_ORDINARY, self.n)

    @cached_property
    def edges(self) -> Index:
        """(2n - 3, 2) sensing edges E_s as rows (observer, observed).

        Row 0 is the first follower's edge to the leader; rows 2k - 5 and 2k - 4 (k its number) are the edges of
        follower k to its neighbours i < j. Measurements follow this order everywhere.
        """
        first = [[agents.FIRST_FOLLOWER, agents.LEADER]]
        rest = np.stack([np.repeat(self.followers, 2), self.neighbours.ravel()], axis=1)
        return np.concatenate([np.array(first, dtype=np.intp), rest])

    @cached_property
    def corners(self) -> Index:
        """(n - 2, 2) rows of :attr:`edges` that share an observer: the two edges of each follower."""
        return corners(self.edges)

    @cached_property
    def triangles(self) -> Index:
        """(n - 2, 3) triangles (i, j, k), i < j < k, one for each follower k (paper, Section 3.1)."""
        return np.concatenate([self.neighbours, self.followers[:, None]], axis=1)

    @cached_property
    def formation_edges(self) -> Index:
        """(m, 2) edges E_f of the formation graph: E_s and, for each follower, the pair of its neighbours.

        A pair is directed from the larger number to the smaller (Assumption 2). Edges of E_s come first.
        """
        sensed = {(int(k), int(i)) for k, i in self.edges}
        added = [(int(j), int(i)) for i, j in self.neighbours]
        extra = [edge for edge in dict.fromkeys(added) if edge not in sensed]
        return np.concatenate([self.edges, np.array(extra, dtype=np.intp).reshape(-1, 2)])

    @cached_property
    def depth(self) -> Index:
        """(n,) length of the longest chain of sensing edges from each agent to the leader (the cascade's depth)."""
        depth = [0, 1]
        for i, j in self.neighbours.tolist():
            depth.append(1 + max(depth[i], depth[j]))
        return np.array(depth, dtype=np.intp)


def _count(degree: int) -> str:
    return "1 neighbour" if degree == 1 else f"{degree} neighbours"
