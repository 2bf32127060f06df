"""Where labels go, so that they cover neither each other nor what they name."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from scenarios.figures.palette import FAINT, INK
from scenarios.figures.style import SMALL

Real = NDArray[np.float64]

POINTS_PER_INCH = 72.0
_DIRECTIONS = 16
_FROM_ABOVE = np.array(sorted(range(1 - _DIRECTIONS // 2, _DIRECTIONS // 2 + 1), key=abs))
"""Directions in the order in which they are tried: straight above first, straight below last."""

_RINGS = (1.0, 1.5, 2.2, 3.2, 4.5)
"""Distances from the anchor that are tried, in multiples of the nearest."""

_FAR = 2
"""Rings before those from which a line leads back."""

_ENOUGH, _STEP_BACK, _TURN_AWAY = 0.85, 0.25, 0.01
"""Clearance that counts as enough, and what one ring out, or one direction farther from above, must gain, in heights of
the type."""

_DENSE, _RASTER = 100_000, 0.5
"""Occupied points from which on they are merged where they are nearer than this, points of type."""

_SEARCHED = 20_000
"""Occupied points from which on a tree is searched for those near a label, at so many places along its middle:"""
_ALONG = 5

_COVERING, _LEGIBLE = 0.5, 0.35
"""Clearance, in heights of the type, below which a label hides what is near, and is left out on crowded axes."""

_FREE = 2.0
"""Points of type between a line and what it must not cross."""

_HALF_HEIGHT = 0.33
"""Of a figure, in heights of the type."""


def points_per_metre(axes: Axes) -> float:
    """Scale of axes with equal aspect."""
    figure = axes.get_figure(root=True)
    inches = figure.get_size_inches()[0] * axes.get_position().width if figure is not None else 0.0
    low, high = axes.get_xlim()
    return float(inches * POINTS_PER_INCH / (high - low))


class Labels:
    """Places labels one after another on axes with equal aspect, each in the emptiest direction around its anchor.

    Args:
        axes: with their final limits.
        occupied: (q, 2) points, metres, that no label should cover.
        solid: (s, 2) points, metres, that neither labels nor the lines that lead back to them should.
    """

    def __init__(self, axes: Axes, occupied: Real, solid: Real | None = None) -> None:
        self._axes = axes
        self._scale = points_per_metre(axes)
        self._solid = np.empty((0, 2)) if solid is None else solid[np.isfinite(solid).all(axis=1)] * self._scale
        finite = np.concatenate([occupied.reshape(-1, 2), self._solid / self._scale])
        points = finite[np.isfinite(finite).all(axis=1)] * self._scale
        if len(points) > _DENSE:
            points = np.unique(np.round(points / _RASTER).astype(np.int32).view(np.int64)).view(np.int32)
            points = _RASTER * points.reshape(-1, 2)
        self._occupied = points[np.argsort(points[:, 0])]  # by x: a thousand trails are searched for every label
        self._tree: Any = _tree(points) if len(points) > _SEARCHED else None
        self._labels = np.empty((0, 2))

    def put(self, anchor: Real, text: str, distance: float, size: float = SMALL, crowded: bool = False) -> None:
        """Write ``text`` near ``anchor`` (2,), metres, with its centre ``distance`` points away or somewhat more.

        One that is far off is led back by a line. Where the axes are ``crowded``, a label without a free place is left
        out.
        """
        centre = anchor * self._scale
        half_width = 0.25 * size * len(text)
        turn = 1j * np.exp(2j * np.pi * _FROM_ABOVE / _DIRECTIONS)
        direction = np.stack([turn.real, turn.imag], axis=1)
        reach = _RINGS[: _FAR + 1] if crowded else _RINGS
        rings = [direction * (ring * distance + half_width * np.abs(direction[:, :1])) for ring in reach]
        candidates = centre + np.concatenate(rings)
        loss = size * (_STEP_BACK * np.arange(len(reach))[:, None] + _TURN_AWAY * np.abs(_FROM_ABOVE)).ravel()
        clearance = self._clearance(candidates, half_width, size)
        if crowded and clearance.max() < _LEGIBLE * size:
            return
        score = clearance - loss - 2.0 * np.clip(size - clearance / _COVERING, 0.0, size)
        far = slice(_DIRECTIONS * _FAR, None)
        if score.argmax() >= far.start:  # else none of those that it takes something from is chosen anyway
            misleading = self._misleading(centre, candidates[far], distance, half_width + size)
            score[far] -= np.where(misleading, 0.6 * size, 0.0)
        if crowded and clearance[score.argmax()] < _LEGIBLE * size:
            return
        chosen = int(score.argmax())
        best = candidates[chosen]
        if chosen >= _DIRECTIONS * _FAR:  # too far off for the eye to join them
            ends = np.stack([centre, best - np.clip(best - centre, -half_width, half_width) * [1.0, 0.0]]) / self._scale
            self._axes.plot(*ends.T, color=FAINT, linewidth=0.5, zorder=1.6, solid_capstyle="butt")
        box = half_width * np.array([-1.0, 0.0, 1.0])[:, None] + 1j * _HALF_HEIGHT * size * np.array([-1.0, 1.0])
        self._labels = np.concatenate([self._labels, best + np.stack([box.real, box.imag], axis=-1).reshape(-1, 2)])
        x, y = best / self._scale
        self._axes.text(x, y, text, fontsize=size, color=INK, ha="center", va="center_baseline", zorder=6)

    def _clearance(self, candidates: Real, half_width: float, size: float) -> Real:
        """How empty each candidate (c, 2) is, points; the same for all that are empty enough, negative off the axes."""
        (x0, x1), (y0, y1) = (
            np.array(limits) * self._scale for limits in (self._axes.get_xlim(), self._axes.get_ylim())
        )
        reach = half_width + _ENOUGH * size
        if self._tree is None:
            nearest = _gaps(candidates, np.concatenate([self._near(candidates, reach), self._labels]), half_width)
        else:
            nearest = np.minimum(
                _gaps(candidates, self._labels, half_width), self._searched(candidates, half_width, _ENOUGH * size)
            )
        inside = (candidates[:, 0] - half_width > x0) & (candidates[:, 0] + half_width < x1)
        inside &= (candidates[:, 1] - 0.5 * size > y0) & (candidates[:, 1] + 0.5 * size < y1)
        return np.where(inside, np.minimum(nearest, _ENOUGH * size), -size)

    def _misleading(self, centre: Real, candidates: Real, distance: float, apart: float) -> NDArray[np.bool_]:
        """(c,) whether candidates (c, 2) are nearer to something solid than ``apart``, or their lines cross it.

        The lines lead back to ``centre``, within ``distance`` of which is what they name.
        """
        way = candidates - centre
        reach = np.linalg.norm(way, axis=-1).max(initial=0.0) + max(apart, _FREE)  # what is farther off matters to none
        things, labels = (
            each[np.hypot(each[:, 0], each[:, 1]) <= reach] for each in (self._solid - centre, self._labels - centre)
        )
        things = things[np.hypot(things[:, 0], things[:, 1]) > distance]
        found = np.linalg.norm(way[:, None] - things, axis=-1).min(axis=1, initial=np.inf) < apart
        things = np.concatenate([things, labels])
        share = np.clip(way @ things.T / (way**2).sum(axis=1, keepdims=True), 0.0, 1.0)
        gap = np.linalg.norm(share[..., None] * way[:, None] - things, axis=-1)
        return np.asarray(found | (gap.min(axis=1, initial=np.inf) < _FREE))

    def _near(self, candidates: Real, reach: float) -> Real:
        """(q, 2) what is occupied within ``reach`` points of any candidate (c, 2), and some more."""
        low, high = candidates.min(axis=0) - reach, candidates.max(axis=0) + reach
        first, last = np.searchsorted(self._occupied[:, 0], [low[0], high[0]])
        band = self._occupied[first:last]
        return band[(band[:, 1] >= low[1]) & (band[:, 1] <= high[1])]

    def _searched(self, candidates: Real, half_width: float, enough: float) -> Real:
        """(c,) the gap to what is occupied, found in the tree; infinite where it is enough."""
        along = np.linspace(-half_width, half_width, _ALONG)[:, None, None] * [1.0, 0.0]
        distances, _ = self._tree.query(candidates + along, distance_upper_bound=enough)
        return np.asarray(distances).min(axis=0)


def _tree(points: Real) -> Any:
    from scipy.spatial import KDTree

    return KDTree(points)


def _gaps(candidates: Real, points: Real, half_width: float) -> Real:
    """(c,) distance of the nearest of points (q, 2) from a label's middle, a line of half a width to either side."""
    offset = points - candidates[:, None, :]
    gap = np.hypot(np.maximum(np.abs(offset[..., 0]) - half_width, 0.0), offset[..., 1])
    return np.asarray(gap.min(axis=1, initial=np.inf))
