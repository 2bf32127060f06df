"""Starts and predicted ends at which the robots do not fit, known before anything moves.

A law that converges takes its robots to the predicted end of each phase. Where two of them are too close there, one is
off the floor, in a wall or in an obstacle, no filter and no luck makes the run succeed. A start is known with headings,
so there the very points are checked that the testbed checks.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robots.testbed import COLLISION_DISTANCE, OBSTACLE_DISTANCE, collision_centres, separation
from scenarios.definition.events.event import SAME_TIME
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import predicted_ends
from scenarios.simulation.outages import standing

Real = NDArray[np.float64]

MOST_NAMED = 5
"""Agents off the floor that are named one by one."""


def misfits(experiment: Experiment, start: Real) -> list[str]:
    """One sentence for each thing that does not fit at the end of a phase, from a start (n, 2), metres.

    Nothing for points, which neither have wheels nor collide, and nothing where no end is predicted.
    """
    if not experiment.predicted or experiment.plant == "single_integrator":
        return []
    ends = predicted_ends(experiment, start)
    times = np.cumsum([phase.duration for phase in experiment.phases]) - 2.0 * SAME_TIME
    return [
        f"phase {phase.name} ends with {what}"
        for phase, end, t in zip(experiment.phases, ends, times.tolist(), strict=True)
        for what in _at_end(experiment, end, t)
    ]


def too_wide(experiment: Experiment) -> list[str]:
    """One sentence where robots with a body or a projection distance of their own may touch within the filter's rules.

    A filter keeps projected points apart, whichever way the robots turn about these.
    """
    alike = all(agent.robot is None for agent in experiment.scenario.agents)
    if alike or experiment.safety not in ("decentralised", "centralised"):
        return []
    ahead = np.broadcast_to(experiment.fleet.nid.projection_distance, experiment.n)
    corners = experiment.fleet.outlines - np.stack([ahead, np.zeros(experiment.n)], axis=-1)[:, None]
    reach = np.linalg.norm(corners, axis=-1).max(axis=-1)
    other, row = np.argsort(reach, kind="stable")[-2:].tolist()
    kept = experiment.filter_settings.safe_distance
    if reach[row] + reach[other] <= kept:
        return []
    return [
        f"the hull of {experiment.name(row)} reaches {reach[row]:.3f} m from its projected point and that of "
        f"{experiment.name(other)} {reach[other]:.3f} m: they may touch, the safety filter keeps {kept:g} m between "
        "the points (safety.safe_distance_m)"
    ]


def start_misfits(experiment: Experiment, points: Real, headings: Real) -> list[str]:
    """One sentence for each thing that does not fit at the start, projected points (n, 2), metres, and headings (n,).

    Nothing for points, which neither have wheels nor collide.
    """
    if experiment.plant == "single_integrator":
        return []
    poses = experiment.fleet.nid.poses(points, headings)
    centres = collision_centres(poses)
    found = [*_too_close(experiment, centres), *_in_a_wall(experiment, centres)]
    found += _in_an_obstacle(experiment, centres, 0.0)
    outside = np.flatnonzero(~experiment.arena.contains(poses[:, :2]))
    found += [f"{_at(experiment, row, points)}: its axle is off the floor" for row in outside[:MOST_NAMED]]
    if len(outside) > MOST_NAMED:
        found.append(f"{len(outside) - MOST_NAMED} more agents: off the floor")
    return [f"the run starts with {what}" for what in found]


def _at_end(experiment: Experiment, end: Real, t: float) -> Iterator[str]:
    yield from _too_close(experiment, end)
    depth, ahead = _depth(experiment, end), np.broadcast_to(experiment.fleet.nid.projection_distance, len(end))
    row = int(depth.argmin())
    if depth[row] < -ahead[row]:  # its axle too, whichever way it heads
        yield f"{_at(experiment, row, end)}: off the floor"
    else:
        yield from _in_a_wall(experiment, end)
    yield from _in_an_obstacle(experiment, end, t)


def _depth(experiment: Experiment, points: Real) -> Real:
    """(n,) distance of each point (n, 2) from the nearest side of the floor, metres, negative beyond it."""
    planes = experiment.arena.half_planes
    return (points @ planes[:, :2].T - planes[:, 2]).min(axis=1)


def _too_close(experiment: Experiment, points: Real) -> Iterator[str]:
    near = separation(points[None])
    distance, pair = float(near.distance[0]), experiment.numbered(near.pairs[0]).tolist()
    apart = f"agents {pair[0]} and {pair[1]} {distance:.3f} m apart"
    kept = experiment.filter_settings.safe_distance
    if distance < COLLISION_DISTANCE:
        yield f"{apart}: the testbed rejects less than {COLLISION_DISTANCE:g} m"
    elif experiment.safety in ("decentralised", "centralised") and distance < kept:
        yield f"{apart}: the safety filter keeps {kept:g} m"


def _in_a_wall(experiment: Experiment, points: Real) -> Iterator[str]:
    """The first chassis that reaches into a wall whichever way it heads."""
    depth = _depth(experiment, points)
    row = int(depth.argmin())
    chassis = experiment.fleet.bodies[row]
    if experiment.arena.walls and 0.0 <= depth[row] < min(chassis.length, chassis.width) / 2.0:
        yield f"{_at(experiment, row, points)}: {depth[row]:.3f} m from a wall, in which its chassis stands"


def _in_an_obstacle(experiment: Experiment, points: Real, t: float) -> Iterator[str]:
    """Of the obstacles that stand at a time, seconds."""
    there = zip(experiment.arena.obstacles, standing(experiment, t), strict=True)
    for number, (obstacle, stands) in enumerate(there, start=1):
        if not stands:
            continue
        gaps = obstacle.distance(points)
        if gaps.min() < OBSTACLE_DISTANCE:
            where = _at(experiment, int(gaps.argmin()), points)
            yield f"{where}: less than {OBSTACLE_DISTANCE:g} m from obstacle {number}"


def _at(experiment: Experiment, row: int, end: Real) -> str:
    x, y = np.round(end[row], 2) + 0.0  # no minus before a zero
    return f"{experiment.name(row)} at ({x:g}, {y:g}) m"
