"""The searches over pairs of neighbours, compiled: at each agent all pairs of those that are in already.

S_kij = sin^2 of the angle at k between i and j is the follower's rate. Each function starts from agents that are in,
``depth`` >= 0, and takes in others, writing the pair of each into ``pairs`` (n, 2) and its depth into ``depth`` (n,).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

F = TypeVar("F", bound=Callable[..., Any])


def _compiled(function: F) -> F:
    """Compiled on its first call; the machine code is kept for the next process where it can be written."""
    try:
        return cast(F, njit(cache=True)(function))
    except RuntimeError:  # numba found no folder for it
        return cast(F, njit(function))


GOOD_ENOUGH = 0.9999
"""sin^2 at which no better pair is looked for."""


@_compiled
def _sine2(directions: Real, k: int, i: int, j: int) -> float:
    cross = directions[k, i, 0] * directions[k, j, 1] - directions[k, i, 1] * directions[k, j, 0]
    return cross * cross


@_compiled
def fastest(directions: Real, allowed: Flags, depth: Index, pairs: Index, floor: float) -> float:
    """Take in, one by one, the agent with the largest S of a pair that is in; the smallest S taken, the rate.

    The best bottleneck, exactly: an agent that is in never hurts, so whatever can be in at a rate is in at it. Gives up
    below ``floor``, with agents left out.
    """
    n = len(depth)
    best = np.full(n, -1.0)
    members = np.empty(n, np.int64)
    count, rate = 0, np.inf
    waiting = np.empty(n, np.int64)
    fresh = 0
    for k in range(n):
        if depth[k] >= 0:
            waiting[fresh] = k
            fresh += 1
    while fresh > 0:
        fresh -= 1
        m = waiting[fresh]
        for k in range(n):
            if depth[k] < 0 and allowed[k, m]:
                for place in range(count):
                    i = members[place]
                    if allowed[k, i]:
                        s = _sine2(directions, k, i, m)
                        if s > best[k]:
                            best[k] = s
                            pairs[k, 0], pairs[k, 1] = min(i, m), max(i, m)
        members[count] = m
        count += 1
        if fresh > 0:
            continue
        chosen = -1
        for k in range(n):
            if depth[k] < 0 and best[k] > floor and (chosen < 0 or best[k] > best[chosen]):
                chosen = k
        if chosen >= 0:
            depth[chosen] = 1 + max(depth[pairs[chosen, 0]], depth[pairs[chosen, 1]])
            rate = min(rate, best[chosen])
            waiting[0] = chosen
            fresh = 1
    for k in range(n):
        if depth[k] < 0:
            pairs[k] = -1
    return rate


@_compiled
def shallow(directions: Real, gaps: Real, allowed: Flags, depth: Index, pairs: Index, rate: float, quiet: bool) -> int:
    """Take in, round by round, every agent that has a pair with S >= ``rate`` among those in; how many are in.

    An agent that comes in late had no pair before, so its depth is the least that this rate allows. Of several pairs
    the one with the least depth is taken, of those the largest S, or with ``quiet`` the least |1 - w|^2 + |w|^2.
    """
    n = len(depth)
    members = np.empty(n, np.int64)
    count, old = 0, 0
    for k in range(n):
        if depth[k] >= 0:
            members[count] = k
            count += 1
    while True:
        joined = 0
        for k in range(n):
            if depth[k] >= 0:
                continue
            found, best, level = False, -np.inf, n + 2
            for second in range(max(old, 1), count):  # a pair of two old members was no good before
                j = members[second]
                if not allowed[k, j] or (best >= GOOD_ENOUGH and not quiet):
                    continue
                for first in range(second):
                    i = members[first]
                    if not allowed[k, i]:
                        continue
                    s = _sine2(directions, k, i, j)
                    if s < rate:
                        continue
                    deep = 1 + max(depth[i], depth[j])
                    merit = -(gaps[k, i] ** 2 + gaps[k, j] ** 2) / gaps[i, j] ** 2 if quiet else s
                    if deep < level or (deep == level and merit > best):
                        found, best, level = True, merit, deep
                        pairs[k, 0], pairs[k, 1] = min(i, j), max(i, j)
            if found:
                members[count + joined] = k
                joined += 1
        old = count
        if joined == 0:
            break
        for place in range(count, count + joined):
            k = members[place]
            depth[k] = 1 + max(depth[pairs[k, 0]], depth[pairs[k, 1]])
        count += joined
    return count


@_compiled
def quietest(
    directions: Real, gaps: Real, allowed: Flags, depth: Index, pairs: Index, cost: Real, rate: float, period: float
) -> float:
    """Take in, one by one, the agent with the least noise; the largest noise, relative to sigma^2.

    c_k = |1 - w|^2 c_i + |w|^2 c_j + T S (|1 - w|^2 + |w|^2), as if the neighbours' errors were independent, over
    pairs with S >= ``rate``. Best first, because an agent that is in never hurts another.

    Args:
        cost: (n,) in: that of the agents that are in; out: c.
        period: T, seconds.
    """
    n = len(depth)
    best = np.full(n, np.inf)
    members = np.empty(n, np.int64)
    waiting = np.empty(n, np.int64)
    count, fresh, worst = 0, 0, 0.0
    for k in range(n):
        if depth[k] >= 0:
            waiting[fresh] = k
            fresh += 1
    while fresh > 0:
        fresh -= 1
        m = waiting[fresh]
        for k in range(n):
            if depth[k] < 0 and allowed[k, m]:
                for place in range(count):
                    i = members[place]
                    if allowed[k, i]:
                        s = _sine2(directions, k, i, m)
                        if s >= rate:
                            base = gaps[i, m] ** 2
                            towards_m, towards_i = gaps[k, i] ** 2 / base, gaps[k, m] ** 2 / base
                            c = towards_i * cost[i] + towards_m * cost[m] + period * s * (towards_i + towards_m)
                            if c < best[k]:
                                best[k] = c
                                pairs[k, 0], pairs[k, 1] = min(i, m), max(i, m)
        members[count] = m
        count += 1
        if fresh > 0:
            continue
        chosen = -1
        for k in range(n):
            if depth[k] < 0 and best[k] < np.inf and (chosen < 0 or best[k] < best[chosen]):
                chosen = k
        if chosen >= 0:
            depth[chosen] = 1 + max(depth[pairs[chosen, 0]], depth[pairs[chosen, 1]])
            cost[chosen] = best[chosen]
            worst = max(worst, best[chosen])
            waiting[0] = chosen
            fresh = 1
    for k in range(n):
        if depth[k] < 0:
            pairs[k] = -1
            worst = np.inf
    return worst


@_compiled
def direct(directions: Real, allowed: Flags, rate: float) -> Index:
    """(n, n) to how many agents each pair, as leaders, gives S >= ``rate`` at once."""
    n = len(directions)
    found = np.zeros((n, n), np.int64)
    for k in range(n):
        for i in range(n):
            if allowed[k, i]:
                for j in range(i):
                    if allowed[k, j] and _sine2(directions, k, i, j) >= rate:
                        found[i, j] += 1
                        found[j, i] += 1
    return found
