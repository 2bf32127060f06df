"""The searches over graphs: the best rate exactly, shallow at a rate, least noise, over given or all leaders.

An agent that is in the graph never keeps another one out, so greedy is exact: what can be reached at a rate is what
keeps being added until nothing more can be.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import combinations

import numpy as np

from formation.design.field import NONDEGENERATE, Choice, Field
from formation.graph.sensing import Index

EXHAUSTIVE = 120
"""Agents up to which all pairs of leaders are tried; beyond it, those that the most agents could sense both of."""

PROMISING = 6
"""Pairs of leaders that are tried of more agents."""

PROMISING_RATE = 0.8

TIE = 1e-9
"""1/s: rates that differ by less are the same but for rounding."""

Search = Callable[[Index, Index], float]


def fastest(field: Field, leaders: tuple[int, int], floor: float = NONDEGENERATE) -> tuple[float, Choice]:
    """The largest rate, 1/s, of any leader-first-follower graph with these leaders, and one that has it.

    Agents that cannot be reached at a rate above ``floor`` are left out, and then the rate is 0.
    """
    from formation.design import kernel  # numba is loaded only where it is used

    choice, rate = _search(field, leaders, lambda depth, pairs: kernel.fastest(*_given(field), depth, pairs, floor))
    return (float(min(rate, 1.0)) if choice.whole else 0.0), choice


def shallow(field: Field, leaders: tuple[int, int], rate: float = NONDEGENERATE, quiet: bool = False) -> Choice:
    """The graph with these leaders in which every agent has the least depth that followers of ``rate`` 1/s allow.

    Where it has a choice, an agent takes the fastest pair, or with ``quiet`` the one that hands on the least noise.
    """
    return _search(field, leaders, _rounds(field, rate, quiet))[0]


def quietest(field: Field, leaders: tuple[int, int], rate: float, period: float, steered: bool) -> tuple[float, Choice]:
    """The graph of least noise with these leaders and followers of at least ``rate`` 1/s, and its largest rms noise,
    metres per metre of sensor noise, estimated as if neighbours' errors were independent.

    Args:
        field: what there is to choose from.
        leaders: rows of the leader and of the first follower.
        rate: 1/s.
        period: control period, seconds.
        steered: whether the first follower is steered by displacement, and so has noise of its own.
    """
    from formation.design import kernel

    cost = np.zeros(field.n)
    if steered:
        cost[leaders[1]] = 2.0 * period / (2.0 - period)

    def search(depth: Index, pairs: Index) -> float:
        directions, allowed = _given(field)
        return kernel.quietest(directions, field.gaps, allowed, depth, pairs, cost, rate, period)

    choice, worst = _search(field, leaders, search)
    return float(np.sqrt(worst)), choice


def reached_from(field: Field, start: Choice, more: Iterable[int]) -> Choice:
    """The closure of a choice to which agents (rows) are added as if their neighbours were given."""
    depth, pairs = start.depth.copy(), start.pairs.copy()
    depth[list(more)] = 1 + int(depth.max())
    _rounds(field, NONDEGENERATE, False)(depth, pairs)
    return Choice(start.leaders, pairs, depth)


def leader_pairs(field: Field, needs_edge: bool) -> Iterator[tuple[int, int]]:
    """The pairs of leaders that are worth trying, both ways round where that matters.

    Args:
        field: what there is to choose from.
        needs_edge: whether the first follower has to sense the leader.
    """
    pairs: Iterable[tuple[int, int]] = combinations(range(field.n), 2)
    if field.n > EXHAUSTIVE:
        from formation.design import kernel

        found = np.triu(kernel.direct(*_given(field), PROMISING_RATE) * (field.gaps > 0.0))
        best = np.argsort(found, axis=None)[::-1][:PROMISING]
        pairs = [(int(a), int(b)) for a, b in zip(*np.unravel_index(best, found.shape), strict=True)]
    for a, b in pairs:
        if field.gaps[a, b] == 0.0:
            continue
        if not needs_edge or field.allowed[b, a]:
            yield a, b
        elif field.allowed[a, b]:
            yield b, a


def best_leaders(field: Field, needs_edge: bool) -> tuple[float, Choice] | None:
    """The largest rate over all leaders and graphs, and of the leaders that reach it those of the least depth; exact up
    to :data:`EXHAUSTIVE` agents. None where no leaders reach every agent.

    Depth is the largest over the agents, then the mean; the leaders with the smallest rows where even that is equal.
    """
    best, found = NONDEGENERATE, []
    for leaders in leader_pairs(field, needs_edge):
        rate, choice = fastest(field, leaders, best - TIE)
        if choice.whole:
            found.append((rate, leaders))
            best = max(best, rate)
    if not found:
        return None
    choices = [shallow(field, leaders, best - TIE) for rate, leaders in found if rate >= best - TIE]
    return best, min(choices, key=lambda choice: (choice.depth.max(), choice.depth.mean(), choice.leaders))


def _rounds(field: Field, rate: float, quiet: bool) -> Search:
    from formation.design import kernel

    directions, allowed = _given(field)
    return lambda depth, pairs: kernel.shallow(directions, field.gaps, allowed, depth, pairs, rate, quiet)


def _given(field: Field) -> tuple[np.ndarray, np.ndarray]:
    return field.directions, field.allowed


def _search(field: Field, leaders: tuple[int, int], search: Search) -> tuple[Choice, float]:
    depth, pairs = np.full(field.n, -1, dtype=np.intp), np.full((field.n, 2), -1, dtype=np.intp)
    depth[list(leaders)] = 0, 1
    found = search(depth, pairs)
    return Choice(leaders, pairs, depth), found
