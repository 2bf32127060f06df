"""The seven distance sensors of each robot: rays against line obstacles and against the other robots, seen as discs.

Sensors are (3, S) places and directions x, y, theta in the frame of the axle's centre. Obstacles are (M, 2, 2) lines,
[k, 0] the one end of the k-th and [k, 1] the other. Distances are (S, N), metres.
"""

from __future__ import annotations

import numpy as np

from robots.rps.columns import Real

PARALLEL = 1e-10
"""Of a ray's and an obstacle's cross product, m^2, below which they never meet."""


def endpoints(poses: Real, sensors: Real, distances: Real) -> Real:
    """(2, S, N) where rays of ``distances`` end, metres; NaN where a distance is negative: nothing was seen."""
    origin, direction = _rays(poses, sensors)
    return origin + np.where(distances >= 0.0, distances, np.nan) * direction


def against_lines(poses: Real, sensors: Real, lines: Real | None, reach: float) -> Real:
    """(S, N) the distances to the nearest of ``lines`` (M, 2, 2), or ``reach``."""
    origin, direction = _rays(poses, sensors)
    if lines is None or not np.size(lines):
        return np.full(origin.shape[1:], reach)
    ray = reach * direction[..., None]
    begin = lines[:, 0].T[:, None, None] - origin[..., None]
    side = (lines[:, 1] - lines[:, 0]).T[:, None, None]
    cross = _cross(ray, side)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = _cross(begin, side) / cross, _cross(begin, ray) / cross
        met = (np.abs(cross) >= PARALLEL) & (along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0)
    return reach * np.where(met, along, 1.0).min(axis=-1)


def against_discs(poses: Real, sensors: Real, radius: float, reach: float) -> Real:
    """(S, N) the distances to the nearest other robot, a disc of ``radius`` about its pose, or ``reach``."""
    origin, direction = _rays(poses, sensors)
    to = poses[:2, None, None, :] - origin[..., None]
    ahead = (to * direction[..., None]).sum(axis=0)
    beside = np.abs(_cross(to, direction[..., None]))
    with np.errstate(invalid="ignore"):
        distance = ahead - np.sqrt(radius**2 - beside**2)
    met = (beside <= radius) & (ahead >= 0.0) & (ahead <= reach) & (distance >= 0.0)
    met &= ~np.eye(poses.shape[1], dtype=bool)
    return np.where(met, distance, reach).min(axis=-1, initial=reach)


def _rays(poses: Real, sensors: Real) -> tuple[Real, Real]:
    """(2, S, N) origins, metres, and unit directions."""
    c, s = np.cos(poses[2]), np.sin(poses[2])
    x, y, theta = sensors[:, :, None]
    origin = np.array([c * x - s * y, s * x + c * y]) + poses[:2, None]
    return origin, np.array([np.cos(poses[2] + theta), np.sin(poses[2] + theta)])


def _cross(a: Real, b: Real) -> Real:
    return a[0] * b[1] - a[1] * b[0]
