"""Random target formations on random leader-first-follower graphs, nondegenerate by a given angle."""

from __future__ import annotations

import math

import numpy as np

from formation.constraint import interior_angles
from formation.graph.sensing import SensingGraph
from formation.plane import Real
from formation.target import TargetFormation

CANDIDATES = 64
"""Places and neighbour pairs that are drawn at once for one follower."""

MAX_ROUNDS = 1000


def random_target(
    n: int,
    rng: np.random.Generator,
    min_angle: float = np.radians(15.0),
    min_separation: float = 0.0,
    radius: float = 1.0,
) -> TargetFormation:
    """A target drawn uniformly in a disc, agent by agent, each with two random neighbours among those before it.

    Args:
        n: number of agents, at least 3.
        rng: source of randomness.
        min_angle: radians by which every interior angle of every triangle stays away from 0, pi and 2 pi.
        min_separation: smallest distance between two agents, metres.
        radius: of the disc, metres.

    Raises:
        ValueError: the disc is too small for the agents, or the angle too large.
    """
    if n < 3:
        raise ValueError(f"a random target needs at least 3 agents, got {n}")
    p = np.empty((n, 2))
    neighbours = np.empty((n - 2, 2), dtype=np.intp)
    least = np.sin(min_angle)
    taken = _Taken(min_separation)
    for k in range(n):
        for _ in range(MAX_ROUNDS):
            places = _disc(CANDIDATES, radius, rng)
            round_enough = np.ones(CANDIDATES, dtype=bool)
            if k >= 2:
                i = rng.integers(0, k, CANDIDATES)
                j = rng.integers(0, k - 1, CANDIDATES)
                j += j >= i
                round_enough = (np.abs(np.sin(interior_angles(p[i], p[j], places))) >= least).all(axis=1)
            chosen = next((c for c in np.flatnonzero(round_enough).tolist() if taken.free(places[c])), None)
            if chosen is not None:
                p[k] = places[chosen]
                taken.add(p[k])
                if k >= 2:
                    neighbours[k - 2] = i[chosen], j[chosen]
                break
        else:
            raise ValueError(
                f"no place for agent {k + 1} of {n}: radius {radius:g} m is too small for a separation of "
                f"{min_separation:g} m and angles of at least {np.degrees(min_angle):g} degrees"
            )
    return TargetFormation(SensingGraph(neighbours), p)


class _Taken:
    """Points by the cells of a grid as wide as the distance that others keep from them: only nine cells can matter."""

    def __init__(self, separation: float) -> None:
        self._separation = separation
        self._cells: dict[tuple[int, int], list[Real]] = {}

    def _cell(self, point: Real) -> tuple[int, int]:
        x, y = point.tolist()
        return math.floor(x / self._separation), math.floor(y / self._separation)

    def free(self, point: Real) -> bool:
        """Whether no point that was added is nearer than the separation, metres."""
        if self._separation == 0.0:
            return True
        cx, cy = self._cell(point)
        near = [other for dx in (-1, 0, 1) for dy in (-1, 0, 1) for other in self._cells.get((cx + dx, cy + dy), ())]
        return not near or bool((np.linalg.norm(point - np.array(near), axis=-1) >= self._separation).all())

    def add(self, point: Real) -> None:
        if self._separation > 0.0:
            self._cells.setdefault(self._cell(point), []).append(point)


def _disc(count: int, radius: float, rng: np.random.Generator) -> Real:
    """(count, 2) points drawn uniformly in a disc about the origin."""
    r = radius * np.sqrt(rng.uniform(0.0, 1.0, count))
    theta = rng.uniform(-np.pi, np.pi, count)
    return np.stack([r * np.cos(theta), r * np.sin(theta)], axis=-1)
