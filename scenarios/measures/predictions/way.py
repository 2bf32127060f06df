"""The whole predicted way of a run against walls, obstacles and the floor's border, known before anything moves.

It is the exact motion of ideal agents from the start; on a reference with feed-forward, the way of agents in their
places, which do not lag. Neither knows a filter: where the way leads into something, a filter has to lead around it or
holds somebody up. Wheels that a reference outruns are the matter of :mod:`scenarios.measures.predictions.course`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from formation.analysis.cascade import Cascade
from formation.analysis.exact import ideal, points
from formation.plane import as_complex
from robots.safety.protocol import WALLS
from robots.testbed import OBSTACLE_DISTANCE
from scenarios.definition.experiment import Experiment
from scenarios.measures.clearance import standing_at, thing_name
from scenarios.measures.predictions.theory import motion, moves_exactly
from scenarios.measures.tracking import following

Real = NDArray[np.float64]

STEP = 0.1
"""Seconds between two places of the way that are looked at."""

MOST_STEPS = 20_000

MOST_PLACES = 5_000_000
"""Of all agents at all times that are looked at."""

ROUNDING = 1e-9
"""Metres."""

FILTERED = ("decentralised", "centralised")
"""Safety filters that keep a clearance."""


def way(experiment: Experiment, start: Real) -> tuple[Real, Real] | None:
    """Times (T,), seconds, and points (T, n, 2), metres, from a start (n, 2); None where nothing predicts them."""
    if not experiment.predicted:
        return None
    seconds = sum(phase.duration for phase in experiment.phases)
    step = max(STEP, seconds / MOST_STEPS, seconds * experiment.n / MOST_PLACES)
    if not moves_exactly(experiment):
        if experiment.phases[0].reference is None:
            return None
        t: Real = np.linspace(0.0, seconds, max(2, round(seconds / step) + 1))
        return t, following(experiment, start, t)
    shaped, loop, first = experiment, None, experiment.first_follower
    times, places, here, begin = [np.zeros(1)], [start[None]], start, 0.0
    for index, phase in enumerate(experiment.phases):
        before, shaped = shaped, experiment.of_phase(index)
        if loop is None or shaped is not before:
            loop = Cascade.of(shaped.target, gains=shaped.own_gains)
        steps = max(1, round(phase.duration / step))
        if experiment.estimator is None:
            part = points(ideal(loop, as_complex(here), phase, first, phase.duration / steps), steps)[1:]
        else:
            every = motion(experiment, here, index, continuous=True)
            part = every[np.round(np.linspace(0.0, len(every) - 1, steps + 1)).astype(int)[1:]]
        times.append(begin + phase.duration * np.arange(1, steps + 1) / steps)
        places.append(part)
        here, begin = part[-1], begin + phase.duration
    return np.concatenate(times), np.concatenate(places)


def in_the_way(experiment: Experiment, start: Real) -> list[str]:
    """One sentence for each wall, obstacle and the floor's border that the way from a start (n, 2), metres, meets."""
    if experiment.plant == "single_integrator":
        return []
    found = way(experiment, start)
    return [] if found is None else list(_meetings(experiment, *found))


def _meetings(experiment: Experiment, t: Real, places: Real) -> Iterator[str]:
    arena, kept = experiment.arena, experiment.filter_settings.clearance
    sides = places @ arena.half_planes[:, :2].T - arena.half_planes[:, 2]
    if experiment.safety in FILTERED:
        of_walls = of_obstacles = (kept, f"the safety filter keeps {kept:g} m")
    else:
        of_walls = (max(body.length for body in experiment.fleet.bodies) / 2.0, "in which its chassis stands")
        of_obstacles = (OBSTACLE_DISTANCE, f"the testbed rejects less than {OBSTACLE_DISTANCE:g} m")
    if arena.walls:
        for side in range(WALLS):
            yield from _meeting(experiment, t, sides[..., side], f"the {thing_name(side)}", *of_walls)
    else:
        yield from _leaving(experiment, t, sides.min(axis=-1))
    there = standing_at(experiment, t)
    for number, obstacle in enumerate(arena.obstacles):
        gaps = obstacle.distance(places)
        if there is not None:
            gaps[~there[:, number]] = np.inf
        yield from _meeting(experiment, t, gaps, thing_name(WALLS + number), *of_obstacles)


def _meeting(experiment: Experiment, t: Real, gaps: Real, thing: str, least: float, rule: str) -> Iterator[str]:
    """Who first comes nearer than ``least`` to a thing, and who comes the nearest, of distances (T, n)."""
    near = np.flatnonzero((gaps < least - ROUNDING).any(axis=1))
    if not near.size:
        return
    first, (row, agent) = int(near[0]), np.unravel_index(gaps.argmin(), gaps.shape)
    earliest = experiment.name(int(gaps[first].argmin()))
    how = f"within {gaps[row, agent]:.3f} m of" if gaps[row, agent] > 0.0 else "into"
    yield (
        f"{thing}, to {earliest} from {t[first]:.1f} s on; {experiment.name(int(agent))} would come {how} it at "
        f"{t[row]:.1f} s, {rule}"
    )


def _leaving(experiment: Experiment, t: Real, depth: Real) -> Iterator[str]:
    """Who first leaves the floor, axle and all, by distances (T, n) from its border."""
    outside = np.flatnonzero((depth < -experiment.fleet.nid.projection_distance).any(axis=1))
    if outside.size:
        first = int(outside[0])
        yield f"the floor's border, which {experiment.name(int(depth[first].argmin()))} would cross at {t[first]:.1f} s"
