"""A sweep: how often runs converge and what they reach, over the varied values, or as one distribution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from scenarios.figures.palette import AGENT_COLOURS, FAINT, INK
from scenarios.figures.style import COLUMN, SMALL, panel, print_style, sheet

Real = NDArray[np.float64]

TITLES = {
    "settling_time_s": "settling time (s)",
    "angle_error_sum_rad": "angle error sum (rad)",
    "min_separation_m": "least separation (m)",
    "min_clearance_m": "least clearance (m)",
    "min_hull_clearance_m": "hull's clearance (m)",
}

LOGARITHMIC = ("angle_error_sum_rad",)

LEFT, RIGHT, HEIGHT, GAP = 0.50, 0.10, 0.85, 0.16
"""Inches."""

LABELS = -0.125
"""Where the names of the y axes stand, a share of the width."""

SPREAD = 0.5
"""Width of a column of points, a share of the distance between two columns."""


def dependence(key: str, labels: Sequence[str], shares: Real, values: Mapping[str, Sequence[Real]]) -> Figure:
    """The figure of a sweep, in the style of print.

    Args:
        key: what is varied; empty where nothing is.
        labels: of the varied values, one a combination.
        shares: (combinations, 3) share of the runs that converged, and its 95 % interval.
        values: by column of ``rows.csv``, for each combination what its runs have.
    """
    with print_style():
        if len(labels) == 1:
            return _distributions({column: each[0] for column, each in values.items()})
        figure = sheet(0.46 + (HEIGHT + GAP) * (1 + len(values)))
        width = COLUMN - LEFT - RIGHT
        bottom = 0.46
        places = np.arange(len(labels), dtype=float)
        lowest: Axes | None = None
        for column, each in list(values.items())[::-1]:
            axes = panel(figure, LEFT, bottom, width, HEIGHT, sharex=lowest)
            _columns(axes, places, each)
            axes.set_ylabel(TITLES[column])
            if column in LOGARITHMIC:
                axes.set_yscale("log")
            if lowest is None:
                lowest = axes
                axes.set_xticks(places, labels)
                axes.set_xlim(-0.6, len(labels) - 0.4)
                axes.set_xlabel(key)
            else:
                axes.tick_params(labelbottom=False)
            bottom += HEIGHT + GAP
        top = panel(figure, LEFT, bottom, width, HEIGHT, sharex=lowest)
        beside = np.abs(shares[:, 1:] - shares[:, :1]).T
        top.errorbar(places, shares[:, 0], beside, fmt="o", markersize=3, color=INK, linewidth=0.7, capsize=2)
        top.set(ylim=(-0.05, 1.05), ylabel="converged")
        top.tick_params(labelbottom=False)
        for axes in figure.axes:
            axes.yaxis.set_label_coords(LABELS, 0.5)
        return figure


def _columns(axes: Axes, places: Real, values: Sequence[Real]) -> None:
    """A column of points for each combination, its median, and a bar from the 5 % to the 95 % quantile."""
    for place, own in zip(places, values, strict=True):
        if not len(own):
            axes.annotate(
                "none", (place, 0.5), xycoords=("data", "axes fraction"), ha="center", fontsize=SMALL, color=INK
            )
            continue
        spread = place + SPREAD * (np.arange(len(own)) / max(1, len(own) - 1) - 0.5) * (len(own) > 1)
        axes.plot(spread, own, ".", markersize=2, color=AGENT_COLOURS[0], alpha=0.5, markeredgewidth=0.0)
        low, middle, high = np.quantile(own, (0.05, 0.5, 0.95))
        axes.plot([place, place], [low, high], color=INK, linewidth=0.9)
        axes.plot(place, middle, "o", markersize=3, color=INK)


def _distributions(values: Mapping[str, Real]) -> Figure:
    """The share of the runs below each value."""
    figure = sheet((HEIGHT + 0.42) * len(values) + 0.05)
    for index, (column, own) in enumerate(list(values.items())[::-1]):
        axes = panel(figure, LEFT, 0.36 + index * (HEIGHT + 0.42), COLUMN - LEFT - RIGHT, HEIGHT)
        axes.set(xlabel=TITLES[column], ylabel="share of runs", ylim=(0.0, 1.02))
        if not len(own):
            axes.text(0.5, 0.5, "no run has one", transform=axes.transAxes, ha="center", fontsize=SMALL)
            continue
        axes.axhline(0.5, color=FAINT, linewidth=0.5)
        axes.ecdf(own, color=AGENT_COLOURS[0], linewidth=0.9)
        if column in LOGARITHMIC:
            axes.set_xscale("log")
    return figure
