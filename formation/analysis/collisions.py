"""Collision-free sequential activation, exactly (paper, Lemma 3 and beyond).

While its neighbours stand in their places, a follower moves on the straight segment from its start to its end. So it
comes no nearer to anything at rest than that segment does: necessary and sufficient, where eq. (c3) is only sufficient.

- *Neighbours not quite settled*, each within eps of its place: the path strays from the segment by at most
  (|1 - w_k| + |w_k|) eps, and the neighbour by eps.
- *Non-neighbours* wait at their starts, move on segments of their own or stand at their ends: the distance of the two
  segments covers all three.
- *Sight lines*: while follower k moves, its line of sight to its neighbour i sweeps the triangle p_i, start, end. An
  agent at rest in it crosses the line.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formation import agents
from formation.analysis.cascade import Cascade
from formation.graph.sensing import Index
from formation.plane import Real, as_complex
from formation.target import TargetFormation


def segment_distance(point: ArrayLike, begin: ArrayLike, end: ArrayLike) -> Real:
    """Distance, metres, of points (..., 2) from the segments between (..., 2) and (..., 2); they broadcast."""
    p, a, b = (as_complex(each) for each in (point, begin, end))
    along = b - a
    length = np.abs(along) ** 2
    share = np.divide(
        ((p - a) * np.conj(along)).real, length, out=np.zeros(np.broadcast_shapes(p.shape, a.shape)), where=length > 0.0
    )
    return np.abs(p - a - np.clip(share, 0.0, 1.0) * along)


def segments_distance(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> Real:
    """Distance, metres, of segments a-b and c-d, points (..., 2) that broadcast; 0 where they cross."""
    ends = [segment_distance(a, c, d), segment_distance(b, c, d), segment_distance(c, a, b), segment_distance(d, a, b)]
    nearest = np.minimum.reduce(np.broadcast_arrays(*ends))
    crossing = (_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) < 0.0)
    return np.where(crossing, 0.0, nearest)


def settled_within(target: TargetFormation, tolerance: float) -> Real:
    """(n,) how far from its place an agent may be that counts as settled, metres.

    A follower sees how far it is from where its neighbours are: within ``tolerance`` when it counts as settled, on top
    of what its neighbours' own distances do to its place. Agents 1 and 2 stand.
    """
    bounds = [0.0, 0.0]
    loop = Cascade.of(target)
    for (i, j), (a, b) in zip(target.graph.neighbours.tolist(), np.abs(loop.pulls).tolist(), strict=True):
        bounds.append(tolerance + a * bounds[i] + b * bounds[j])
    return np.array(bounds)


def neighbour_clearance(target: TargetFormation, start: Real, end: Real, settled: Real | None = None) -> Real:
    """(n - 2,) the distance, metres, below which a follower never comes to either of its two neighbours.

    Exact where they stand in their places, a bound where each is within ``settled`` (n,) of it, metres.

    Args:
        target: the target formation.
        start: (..., n, 2) initial positions, metres.
        end: (..., n, 2) the end configuration, metres.
        settled: as above.
    """
    i, j, k = target.graph.triangles.T
    near = np.stack(
        [segment_distance(end[..., m, :], start[..., k, :], end[..., k, :]) for m in (i, j)], axis=-1
    )  # (..., n - 2, 2)
    if settled is not None:
        stray = np.abs(Cascade.of(target).pulls)
        wander = stray[:, 0] * settled[i] + stray[:, 1] * settled[j]
        near = near - np.stack([wander + settled[i], wander + settled[j]], axis=-1)
    return near.min(axis=-1)


def others_clearance(target: TargetFormation, start: Real, end: Real) -> tuple[Real, Index]:
    """(n - 2,) the distance, metres, of each follower's segment from that of the nearest agent that is no neighbour of
    it nor it a neighbour of that one, and (n - 2,) which agent that is; infinite and -1 where there is none."""
    n = target.graph.n
    distance = segments_distance(start[:, None], end[:, None], start[None], end[None])
    distance[np.arange(n), np.arange(n)] = np.inf
    for k, i in target.graph.edges:
        distance[k, i] = distance[i, k] = np.inf
    rows = distance[agents.FIRST_ORDINARY :]
    nearest = rows.min(axis=1)
    return nearest, np.where(np.isfinite(nearest), rows.argmin(axis=1), -1)


def crossed_sight_lines(target: TargetFormation, start: Real, end: Real) -> list[tuple[int, int, int]]:
    """Rows (k, i, m): agent m, at rest in its place, crosses k's line of sight to its neighbour i while k moves.

    Agents before k in the cascade stand at their ends by then, those after it may still be at their starts.
    """
    found = []
    for pair, k in zip(target.graph.neighbours, target.graph.followers, strict=True):
        for i in pair:
            others = np.setdiff1d(np.arange(target.graph.n), [k, i])
            places = np.where((others < k)[:, None], end[others], start[others])
            inside = _in_triangle(places, end[i], start[k], end[k])
            found += [(int(k), int(i), int(m)) for m in others[inside]]
    return found


def _side(a: ArrayLike, b: ArrayLike, p: ArrayLike) -> Real:
    """Twice the signed area of the triangle a, b, p."""
    return (np.conj(as_complex(b) - as_complex(a)) * (as_complex(p) - as_complex(a))).imag


def _in_triangle(p: Real, a: Real, b: Real, c: Real) -> NDArray[np.bool_]:
    sides = np.stack([_side(a, b, p), _side(b, c, p), _side(c, a, p)])
    return np.abs(np.sign(sides).sum(axis=0)) == len(sides)
