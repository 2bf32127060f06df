"""The leader-first-follower graph inside a given one, or what keeps it out (paper, Remark 2).

The law works on any sensing graph that contains a leader-first-follower graph. The closure finds it, whatever the
agents' numbers and however many edges there are to spare. Where there is none it names the agents that cannot be
reached, and the fewest edges that would mend it.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import count

import numpy as np

from formation.design.closure import leader_pairs, reached_from, shallow
from formation.design.field import NONDEGENERATE, Choice, Field

EXACT = 12
"""Agents out of reach up to which the fewest edges are proved; beyond it, they are what looking ahead by one gives."""

EXACT_LEADERS = 30
"""Agents up to which a remedy is looked for with all leaders."""


@dataclass(frozen=True)
class Remedy:
    """Edges that would complete a graph.

    Attributes:
        leaders: rows of the leader and of the first follower.
        edges: rows (observer, observed).
        fewest: whether no smaller number would do with these leaders.
    """

    leaders: tuple[int, int]
    edges: tuple[tuple[int, int], ...]
    fewest: bool


def subgraph(field: Field, leaders: tuple[int, int]) -> Choice:
    """The shallowest leader-first-follower graph with these leaders among the allowed edges, as far as it goes."""
    return shallow(field, leaders)


def any_leaders(field: Field, needs_edge: bool) -> Choice | None:
    """The shallowest among all leaders; None where no leaders reach everybody."""
    found = [shallow(field, leaders) for leaders in leader_pairs(field, needs_edge)]
    whole = [choice for choice in found if choice.whole]
    return min(whole, key=lambda choice: (choice.depth.max(), choice.depth.mean(), choice.leaders), default=None)


def remedy(field: Field, leaders: tuple[int, int], needs_edge: bool) -> Remedy:
    """The fewest edges with which these leaders reach everybody.

    An agent out of reach with one usable neighbour in reach lacks one edge, any other two. Giving one agent its edges
    may bring in others, so the search goes over sets of agents, cheapest first.
    """
    base = () if not needs_edge or field.allowed[leaders[1], leaders[0]] else ((leaders[1], leaders[0]),)
    start = shallow(field, leaders)
    exact = len(start.unreached) <= EXACT
    ticket = count()
    queue = [(0, next(ticket), start, base)]
    seen: set[bytes] = set()
    while queue:
        cost, _, choice, edges = heapq.heappop(queue)
        if choice.whole:
            return Remedy(leaders, edges, exact)
        reached = choice.depth >= 0
        if reached.tobytes() in seen:
            continue
        seen.add(reached.tobytes())
        steps = []
        for k in choice.unreached.tolist():
            added = _lacking(field, reached, k)
            steps.append((cost + len(added), reached_from(field, choice, [k]), (*edges, *added)))
        if not exact:
            steps = [min(steps, key=lambda step: (step[0], len(step[1].unreached)))]
        for price, after, with_edges in steps:
            heapq.heappush(queue, (price, next(ticket), after, with_edges))
    raise ValueError("two agents that coincide cannot be told apart")


def free_remedy(field: Field, needs_edge: bool) -> Remedy | None:
    """The fewest edges over all pairs of leaders; None for so many agents that trying them all would take too long."""
    if field.n > EXACT_LEADERS:
        return None
    pairs = [(a, b) for a in range(field.n) for b in range(field.n) if a != b and field.gaps[a, b] > 0.0]
    found = [remedy(field, leaders, needs_edge) for leaders in pairs if needs_edge or leaders[0] < leaders[1]]
    return min(found, key=lambda each: (len(each.edges), each.leaders))


def _lacking(field: Field, reached: np.ndarray, k: int) -> tuple[tuple[int, int], ...]:
    """The fewest new edges from k to agents in reach that give it a pair, the one with the largest angle."""
    inside = np.flatnonzero(reached)
    cross = np.subtract(
        np.outer(field.directions[k, inside, 0], field.directions[k, inside, 1]),
        np.outer(field.directions[k, inside, 1], field.directions[k, inside, 0]),
    )
    sines = np.triu(cross**2, 1)
    new = (~field.allowed[k, inside]).astype(int)
    price = new[:, None] + new[None, :]
    usable = sines > NONDEGENERATE
    if not usable.any():
        raise ValueError("two agents that coincide cannot be told apart")
    least = price[usable].min()
    i, j = np.unravel_index(np.where(usable & (price == least), sines, -1.0).argmax(), sines.shape)
    return tuple((k, int(inside[m])) for m in (i, j) if new[m])
