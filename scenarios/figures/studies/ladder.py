"""The five rungs of a scenario: angle errors over time, each rung's median and where nine of ten runs are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from scenarios.figures.palette import AGENT_COLOURS, INK
from scenarios.figures.style import COLUMN, panel, sheet
from scenarios.figures.timelines import TIME

Real = NDArray[np.float64]

LEAST = 1e-6
"""Radians; what lies below is left out."""

_LEFT, _RIGHT = 0.46, 0.10


def ladder(times: Real, errors: Mapping[str, Real], goal: float) -> Figure:
    """The figure of times (S,), seconds, and by rung of angle error sums (seeds, S), radians."""
    figure = sheet(2.3)
    axes = panel(figure, _LEFT, 0.60, COLUMN - _LEFT - _RIGHT, 1.60)
    for (rung, series), colour in zip(errors.items(), AGENT_COLOURS, strict=False):
        low, middle, high = np.maximum(np.quantile(series, (0.05, 0.5, 0.95), axis=0), LEAST)
        axes.fill_between(times, low, high, color=colour, alpha=0.18, linewidth=0.0)
        axes.plot(times, middle, color=colour, linewidth=0.9, label=rung)
    axes.axhline(goal, color=INK, linewidth=0.6, linestyle=":")
    axes.set(yscale="log", xlim=(times[0], times[-1]), ylim=(LEAST, 20.0), xlabel=TIME, ylabel="angle error sum (rad)")
    figure.legend(*axes.get_legend_handles_labels(), loc="lower center", ncols=3, bbox_to_anchor=(0.5, 0.015))
    return figure
