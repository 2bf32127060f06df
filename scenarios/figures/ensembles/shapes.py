"""A sheet of small panels: in each a cloud of starts, and the shapes in which runs from there end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from scenarios.figures.palette import AGENT_COLOURS, ALARM, FAINT, INK
from scenarios.figures.style import SMALL, panel, print_style, render, sheet

Real = NDArray[np.float64]

ACROSS = 5
"""Panels in a row."""

SIDE, GAP, TITLE, FOOT = 1.25, 0.12, 0.2, 0.3
"""Inches: of a panel, between two, above one, below all."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """One panel.

    Attributes:
        title: above it.
        corner: in its lower right corner.
        starts: (runs, n, 2) metres.
        ends: (runs, n, 2) metres, laid over each other.
        right: (runs,) which ends are as they should be.
        pairs: (u, 2) rows of agents that a line joins.
    """

    title: str
    corner: str
    starts: Real
    ends: Real
    right: NDArray[np.bool_]
    pairs: NDArray[np.intp]


def shapes(panels: Sequence[Shapes], caption: str) -> bytes:
    """The figure, a PNG: right ends have one colour, all others another, so that constant success shows one shape."""
    down = -(-len(panels) // ACROSS)
    with print_style():
        figure = sheet(down * (SIDE + TITLE + GAP) + FOOT, width=ACROSS * (SIDE + GAP) + GAP)
        height = float(figure.get_figheight())
        for number, each in enumerate(panels):
            left = GAP + (number % ACROSS) * (SIDE + GAP)
            bottom = height - (number // ACROSS + 1) * (SIDE + TITLE + GAP) + GAP
            _fill(panel(figure, left, bottom, SIDE, SIDE), each)
        figure.text(0.5, 0.1 / height, caption, fontsize=SMALL, color=INK, ha="center", va="bottom")
        return render(figure, "png")


def _fill(axes: Axes, each: Shapes) -> None:
    starts = each.starts - each.starts.mean(axis=(0, 1))
    half = 1.05 * float(np.abs(starts).max())
    axes.set(xlim=(-half, half), ylim=(-half, half), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_color(FAINT)
    axes.plot(*starts.reshape(-1, 2).T, ".", color=FAINT, markersize=1.2, markeredgewidth=0.0, zorder=0)
    for chosen, colour, depth in ((~each.right, ALARM, 1), (each.right, AGENT_COLOURS[0], 2)):
        lines = each.ends[chosen][:, each.pairs].reshape(-1, 2, 2)
        strength = min(0.8, 0.15 + 3.0 / max(1, int(chosen.sum())))
        axes.add_collection(LineCollection(list(lines), colors=colour, linewidths=0.5, alpha=strength, zorder=depth))
    axes.set_title(each.title, fontsize=SMALL, color=INK, pad=2.0)
    axes.text(0.96, 0.03, each.corner, transform=axes.transAxes, fontsize=SMALL, ha="right", va="bottom")
