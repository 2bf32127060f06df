"""Where runs end: in the right shape, mirrored, with some triangles flipped, at a wrong rest, moving, or nowhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation import Framework
from formation.analysis.flow import Flow
from formation.plane import as_complex

Real = NDArray[np.float64]

RIGHT, MIRRORED, FLIPPED, WRONG, MOVING, DIVERGED = ENDS = (
    "right",
    "mirrored",
    "flipped",
    "wrong rest",
    "moving",
    "diverged",
)
"""Kinds of ends. Flipped: all sensed distances are the target's, up to one factor, and the shape is not."""

TOLERANCE = 0.01
"""Of the residual: the distance from the nearest similar copy of the target, relative to the formation's size."""

STILL = 1e-3
"""m/s; with a faster agent a run still moves."""


def residual(formation: Framework, points: Real, mirrored: bool = False) -> Real:
    """(...) distance of points (..., n, 2) from the best similar copy of the target, relative to their own spread."""
    star = as_complex(formation.positions)
    star = np.conj(star - star.mean()) if mirrored else star - star.mean()
    p = as_complex(points)
    p = p - p.mean(axis=-1, keepdims=True)
    factor = (p @ np.conj(star)) / (np.abs(star) ** 2).sum()
    spread = np.linalg.norm(p, axis=-1)
    distance: Real = np.linalg.norm(p - factor[..., None] * star, axis=-1) / spread
    return distance


def distances_right(formation: Framework, points: Real) -> NDArray[np.bool_]:
    """(...) whether all sensed distances of points (..., n, 2) are those of the target up to one factor."""
    k, i = formation.graph.edges.T
    ratio = np.abs(np.diff(as_complex(points)[..., [k, i]], axis=-2))[..., 0, :]
    star = as_complex(formation.positions)
    ratio = ratio / np.abs(star[k] - star[i])
    return np.ptp(ratio, axis=-1) < 2.0 * TOLERANCE * ratio.mean(axis=-1)


@np.errstate(all="ignore")
def ends(formation: Framework, flow: Flow) -> NDArray[np.intp]:
    """(runs,) the kind of each end, an index of :data:`ENDS`."""
    p = flow.points
    kinds = np.full(len(p), ENDS.index(WRONG))
    kinds[flow.speed > STILL] = ENDS.index(MOVING)
    kinds[distances_right(formation, p)] = ENDS.index(FLIPPED)
    kinds[residual(formation, p, mirrored=True) < TOLERANCE] = ENDS.index(MIRRORED)
    kinds[residual(formation, p) < TOLERANCE] = ENDS.index(RIGHT)
    kinds[flow.diverged] = ENDS.index(DIVERGED)
    return kinds
