"""Many starts of one row as ideal integrators, each agent with its own compass error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from formation.analysis.flow import Flow, flow
from formation.measurements import perfect
from formation.plane import as_vectors
from scenarios.studies.league.ends import TOLERANCE, residual
from scenarios.studies.league.entries import Player

Real = NDArray[np.float64]

BOX = 1.5
"""Half the side of the square of random starts, over the root mean square distance of the target from its centre."""

NEAR = (0.1, 0.2)
"""Standard deviations of the starts about the target, over the same size."""


def size(one: Player) -> float:
    """Root mean square distance of the target's agents from their centre, metres."""
    p = one.formation.positions
    return float(np.sqrt(((p - p.mean(axis=0)) ** 2).sum(axis=1).mean()))


def random_starts(one: Player, runs: int, seed: int = 0) -> Real:
    """(runs, n, 2) places drawn uniformly from a square, metres; the same for all rows with as many agents."""
    half = BOX * size(one)
    return np.random.default_rng(seed).uniform(-half, half, (runs, *one.formation.positions.shape))


def near_starts(one: Player, runs: int, sigma: float, seed: int = 0) -> Real:
    """(runs, n, 2) the target with every coordinate disturbed by ``sigma`` of its size, metres."""
    draws = np.random.default_rng(seed).normal(0.0, sigma * size(one), (runs, *one.formation.positions.shape))
    return one.formation.positions + draws


def run(
    one: Player,
    starts: Real,
    horizon: float,
    compass_errors: Real | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Flow:
    """The flow of a row from starts (runs, n, 2), with constant compass errors (runs, n), radians."""
    law, graph = one.law, one.formation.graph
    (k, i), corners = graph.edges.T, graph.corners
    errors = np.zeros(starts.shape[:2]) if compass_errors is None else compass_errors
    compass = as_vectors(np.exp(1j * errors)) if law.needs_compass else None

    def velocity(points: Real, runs: NDArray[np.intp]) -> Real:
        measured = perfect(law.measures, points[:, i] - points[:, k], corners)
        return law(*measured, None if compass is None else compass[runs], None)

    def near(points: Real) -> NDArray[np.bool_]:
        return residual(one.formation, points) < TOLERANCE

    return flow(velocity, starts, horizon, near, smallest=one.entry.smallest_step, on_progress=on_progress)
