"""What the theory alone already says against a run: predicted ends at which the robots do not fit.

A law that converges takes its robots to the predicted end of each phase. Where two of them are too close there, one is
off the floor or in an obstacle, no filter and no luck makes the run succeed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from formation import agents
from robots.testbed import COLLISION_DISTANCE, OBSTACLE_DISTANCE, separation
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import predicted_ends

Real = NDArray[np.float64]


def misfits(experiment: Experiment, start: Real) -> list[str]:
    """One sentence for each thing that does not fit at the end of a phase, from a start (n, 2), metres.

    Nothing for points, which neither have wheels nor collide, and nothing where no end is predicted.
    """
    if not experiment.predicted or experiment.plant == "single_integrator":
        return []
    ends = predicted_ends(experiment, start)
    return [
        f"phase {phase.name} ends with {what}"
        for phase, end in zip(experiment.phases, ends, strict=True)
        for what in _at_end(experiment, end)
    ]


def _at_end(experiment: Experiment, end: Real) -> Iterator[str]:
    near = separation(end[None])
    distance, pair = float(near.distance[0]), agents.numbers(near.pairs[0]).tolist()
    apart = f"agents {pair[0]} and {pair[1]} {distance:.3f} m apart"
    kept = experiment.filter_settings.safe_distance
    if distance < COLLISION_DISTANCE:
        yield f"{apart}: the testbed rejects less than {COLLISION_DISTANCE:g} m"
    elif experiment.safety in ("decentralised", "centralised") and distance < kept:
        yield f"{apart}: the safety filter keeps {kept:g} m"
    arena, ahead = experiment.arena, experiment.nid.projection_distance
    depth = end @ arena.half_planes[:, :2].T - arena.half_planes[:, 2]  # of each point inside each side
    row = int(depth.min(axis=1).argmin())
    if depth[row].min() < -ahead:  # its axle too, whichever way it heads
        yield f"{_at(row, end)}: off the floor"
    for number, obstacle in enumerate(arena.obstacles, start=1):
        gaps = obstacle.distance(end)
        if gaps.min() < OBSTACLE_DISTANCE:
            yield f"{_at(int(gaps.argmin()), end)}: less than {OBSTACLE_DISTANCE:g} m from obstacle {number}"


def _at(row: int, end: Real) -> str:
    x, y = np.round(end[row], 2) + 0.0  # no minus before a zero
    return f"{agents.name(row)} at ({x:g}, {y:g}) m"
