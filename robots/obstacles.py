"""Obstacles: discs, segments and convex polygons that robots must not touch.

All three are one thing, a convex core (a point, a segment or a polygon) and everything within a radius of it, so that
the world, the filter and the testbed's verdict share one geometry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Obstacle:
    """All points within ``radius`` of a convex core.

    Attributes:
        vertices: (k, 2) of the core, metres: one of a disc, two of a segment, and of a polygon counter-clockwise.
        radius: metres around the core.

    Raises:
        ValueError: a number is not finite, the radius is negative, a disc has no radius, a segment no length, or the
            polygon is not strictly convex.
    """

    vertices: Real
    radius: float = 0.0

    def __post_init__(self) -> None:
        v = np.array(self.vertices, dtype=np.float64)
        if v.ndim != 2 or v.shape[1] != 2 or not len(v):
            raise ValueError(f"vertices must have the shape (k, 2), got {v.shape}")
        if not np.isfinite(v).all():
            raise ValueError(f"vertices must be finite, got {v.tolist()}")
        if not (np.isfinite(self.radius) and self.radius >= 0.0):
            raise ValueError(f"radius must be a number of m that is not negative, got {self.radius}")
        if len(v) == 1 and self.radius == 0.0:
            raise ValueError("radius of a disc must be positive, got 0")
        if len(v) == 2 and (v[0] == v[1]).all():
            raise ValueError(f"the ends of a segment must differ, got {v[0].tolist()} twice")
        if len(v) > 2:
            v = _counter_clockwise(v)
        v.flags.writeable = False
        object.__setattr__(self, "vertices", v)

    def distance(self, points: ArrayLike) -> Real:
        """Signed distance (...), metres, from the obstacle to points (..., 2); negative inside."""
        return self.nearest(points)[0]

    def nearest(self, points: ArrayLike) -> tuple[Real, Real]:
        """Signed distance (...), metres, and the unit vector (..., 2) from the border's nearest point away from it."""
        p = np.asarray(points, dtype=np.float64)
        a, b = self.vertices, np.roll(self.vertices, -1, axis=0)
        edge, ray = b - a, p[..., None, :] - a
        length2 = (edge**2).sum(axis=-1)
        along = (ray * edge).sum(axis=-1)
        s = np.clip(np.divide(along, length2, out=np.zeros_like(along), where=length2 > 0.0), 0.0, 1.0)
        gaps = ray - s[..., None] * edge
        lengths = np.linalg.norm(gaps, axis=-1)
        best = lengths.argmin(axis=-1)[..., None]
        distance = np.take_along_axis(lengths, best, axis=-1)[..., 0]
        away = np.take_along_axis(gaps, best[..., None], axis=-2)[..., 0, :]
        away = np.divide(away, distance[..., None], out=np.zeros_like(away), where=distance[..., None] > 0.0)
        if len(a) > 2:
            normal = np.stack([edge[:, 1], -edge[:, 0]], axis=-1) / np.sqrt(length2)[:, None]
            outward = (ray * normal).sum(axis=-1)
            side = outward.argmax(axis=-1)
            depth = outward.max(axis=-1)
            inside = depth <= 0.0
            distance = np.where(inside, depth, distance)
            away = np.where(inside[..., None], normal[side], away)
        return distance - self.radius, away

    @property
    def outline(self) -> Real:
        """(m, 2) the border as a closed polygon, metres, round parts as short chords."""
        v, k = self.vertices, len(self.vertices)
        if self.radius == 0.0:
            return v if k == 2 else np.concatenate([v, v[:1]])
        parts = []
        for i in range(k):
            if k == 1:
                start, stop = 0.0, 2.0 * np.pi
            else:
                before, after = v[i] - v[i - 1], v[(i + 1) % k] - v[i]
                start = np.arctan2(-before[0], before[1])
                stop = start + np.mod(np.arctan2(-after[0], after[1]) - start, 2.0 * np.pi)
            angle = np.linspace(start, stop, 2 + int((stop - start) / 0.2))
            parts.append(v[i] + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        border = np.concatenate(parts)
        return np.concatenate([border, border[:1]])


def standing(obstacles: Sequence[Obstacle], there: Sequence[bool]) -> tuple[Obstacle, ...]:
    """The obstacles, and in the place of each that is not there one out of everything's reach."""
    return tuple(one if stands else _ELSEWHERE for one, stands in zip(obstacles, there, strict=True))


def disc(centre: tuple[float, float], radius: float) -> Obstacle:
    """A disc, metres."""
    return Obstacle(np.array([centre]), radius)


def pack(obstacles: Sequence[Obstacle]) -> tuple[Real, NDArray[np.int64], Real]:
    """Vertices (V, 2), first row of each obstacle and end (O + 1,), and radii (O,) of obstacles, as flat arrays."""
    first = np.cumsum([0] + [len(o.vertices) for o in obstacles], dtype=np.int64)
    vertices = np.concatenate([o.vertices for o in obstacles]) if obstacles else np.empty((0, 2))
    return vertices, first, np.array([o.radius for o in obstacles], dtype=np.float64)


_ELSEWHERE = disc((1e6, 1e6), 1.0)


def _counter_clockwise(v: Real) -> Real:
    """The vertices of a strictly convex polygon, counter-clockwise."""
    edge = np.roll(v, -1, axis=0) - v
    after = np.roll(edge, -1, axis=0)
    turn = edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0]
    if (turn < 0.0).all():
        return _counter_clockwise(v[::-1].copy())
    angle = np.arctan2(turn, (edge * after).sum(axis=1)).sum()
    if not (turn > 0.0).all() or angle > 3.0 * np.pi or not (edge**2).sum(axis=1).all():
        raise ValueError(f"a polygon must be strictly convex without crossing itself, got {v.tolist()}")
    return v
