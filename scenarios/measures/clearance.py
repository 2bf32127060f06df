"""How near the robots come to walls and obstacles: their projected points, which the filter keeps off, and their hulls.

The distance of a hull, a rectangle, from an obstacle, everything within a radius of a convex core, is that of two
convex polygons less the radius: where they are apart it is found at a corner of one of them, and where they overlap the
least of the depths along the normals of both tells by how much (the separating axis theorem).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.arena import Arena
from robots.obstacles import Obstacle
from robots.safety.protocol import WALLS
from scenarios.definition.experiment import Experiment
from scenarios.measures.safety_result import row_name
from scenarios.simulation.outages import standing
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Index = NDArray[np.intp]
There = NDArray[np.bool_]

MOST_STATES = 100_000
"""Robots times instants that are looked at together."""


@dataclass(frozen=True, eq=False)
class Nearest:
    """Who is nearest to a wall or an obstacle over time.

    Attributes:
        distance: (T,) metres, negative inside; infinite where there is neither, NaN of a state that is not finite.
        row: (T,) of the agent.
        thing: (T,) a wall, 0 to 3 as in :attr:`Arena.half_planes`, or 4 + the index of an obstacle.
    """

    distance: Real
    row: Index
    thing: Index

    @property
    def lowest(self) -> int:
        """The instant at which it is nearest of all."""
        return int(np.argmin(np.where(np.isnan(self.distance), np.inf, self.distance)))


@dataclass(frozen=True, eq=False)
class Clearance:
    """Distances to walls and obstacles.

    Attributes:
        points: of the projected points.
        hulls: of the chassis; None for points, which have none.
    """

    points: Nearest
    hulls: Nearest | None


def clearance(experiment: Experiment, trajectory: Trajectory) -> Clearance | None:
    """The clearance of a run; None on a floor with neither walls nor obstacles."""
    arena = experiment.arena
    if not (arena.walls or arena.obstacles):
        return None
    there = standing_at(experiment, trajectory.t)
    points = nearest_points(arena, trajectory.points, there)
    if experiment.plant == "single_integrator":
        return Clearance(points, None)
    return Clearance(points, nearest_hulls(arena, experiment.fleet.outlines, trajectory.poses, there))


def standing_at(experiment: Experiment, t: Real) -> There | None:
    """(T, O) which of the arena's obstacles are there at times t (T,), seconds; None where all always are."""
    if all(event.obstacle is None for event in experiment.events):
        return None
    return np.array([standing(experiment, each) for each in t.tolist()], dtype=np.bool_)


def thing_name(thing: int) -> str:
    """How people call a wall or an obstacle.

    >>> thing_name(1), thing_name(4)
    ('east wall', 'obstacle 1')
    """
    return row_name(thing, 0)


def nearest_points(arena: Arena, points: Real, there: There | None = None) -> Nearest:
    """Of points (T, n, 2), metres, from walls and from the obstacles that are ``there`` (T, O); all where None."""
    return _in_parts(points, lambda part: [_to_walls(arena, part), *(o.distance(part) for o in arena.obstacles)], there)


def nearest_hulls(arena: Arena, outlines: Real, poses: Real, there: There | None = None) -> Nearest:
    """Of chassis with corners (n, 4, 2) in their own frames, at poses (T, n, 3), metres and radians; ``there`` as for
    points."""

    def gaps(part: Real) -> list[Real]:
        corners = _corners(outlines, part)
        walls = _to_walls(arena, corners).min(axis=-2)
        return [walls, *(hull_distance(obstacle, corners) for obstacle in arena.obstacles)]

    return _in_parts(poses, gaps, there)


def hull_distance(obstacle: Obstacle, corners: Real) -> Real:
    """Signed distances (...), metres, of rectangles with corners (..., 4, 2), counter-clockwise, from an obstacle."""
    from_corners = obstacle.distance(corners).min(axis=-1) + obstacle.radius
    edge = np.roll(corners, -1, axis=-2) - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / np.linalg.norm(edge, axis=-1, keepdims=True)
    ray = obstacle.vertices[:, None, :] - corners[..., None, :, :]  # (..., k, 4, 2), from each corner to each vertex
    outward = (ray * normal[..., None, :, :]).sum(axis=-1)
    along = (ray * edge[..., None, :, :]).sum(axis=-1) / (edge**2).sum(axis=-1)[..., None, :]
    beside = ray - np.clip(along, 0.0, 1.0)[..., None] * edge[..., None, :, :]
    from_vertices = np.linalg.norm(beside, axis=-1).min(axis=(-1, -2))
    depth = np.maximum(outward.min(axis=-2).max(axis=-1), _core_depth(obstacle.vertices, corners))
    return np.where(depth > 0.0, np.minimum(from_corners, from_vertices), depth) - obstacle.radius


def _core_depth(vertices: Real, corners: Real) -> Real:
    """(...) the largest distance of corners (..., 4, 2) along a normal of a core (k, 2); negative where none parts."""
    if len(vertices) == 1:
        return np.full(corners.shape[:-2], -np.inf)
    edge = np.roll(vertices, -1, axis=0) - vertices
    normal = np.stack([edge[:, 1], -edge[:, 0]], axis=-1) / np.linalg.norm(edge, axis=-1, keepdims=True)
    offset = (vertices * normal).sum(axis=-1)
    return ((corners @ normal.T).min(axis=-2) - offset).max(axis=-1)


def _corners(outlines: Real, poses: Real) -> Real:
    """(..., n, 4, 2) corners, metres, of chassis with corners (n, 4, 2) in their own frames, at poses (..., n, 3)."""
    axis = np.exp(1j * poses[..., 2])
    outline = outlines @ np.array([1.0, 1j])
    centre = poses[..., 0] + 1j * poses[..., 1]
    turned = centre[..., None] + axis[..., None] * outline
    return np.stack([turned.real, turned.imag], axis=-1)


def _to_walls(arena: Arena, points: Real) -> Real:
    """(..., 4) distances of points (..., 2) from the walls, infinite where the floor has none."""
    planes = arena.half_planes
    return points @ planes[:, :2].T - planes[:, 2] if arena.walls else np.full((*points.shape[:-1], WALLS), np.inf)


def _in_parts(states: Real, gaps: Callable[[Real], list[Real]], there: There | None) -> Nearest:
    """The nearest of states (T, n, ...), a stretch of time after the other, so that memory is bounded."""
    steps, n = states.shape[:2]
    size = max(1, MOST_STATES // max(1, n))
    found = []
    for begin in range(0, steps, size):
        distances = gaps(states[begin : begin + size])
        if there is not None:
            for gap, present in zip(distances[1:], there[begin : begin + size].T, strict=True):
                gap[~present] = np.inf
        found.append(_nearest(distances))
    return Nearest(*(np.concatenate(column) for column in zip(*found, strict=True)))


def _nearest(gaps: list[Real]) -> tuple[Real, Index, Index]:
    """Distance, agent and thing, (T,) each, from distances to the walls (T, n, 4) and to each obstacle (T, n)."""
    walls, *obstacles = gaps
    every = np.concatenate([walls, *(gap[..., None] for gap in obstacles)], axis=-1)
    flat = every.reshape(len(every), -1)
    best = flat.argmin(axis=1)  # of NaN, that
    return np.take_along_axis(flat, best[:, None], axis=1)[:, 0], best // every.shape[-1], best % every.shape[-1]
