"""How close the robots come to each other, to walls and to obstacles, against what is allowed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from robots.testbed import COLLISION_DISTANCE
from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import ALARM, FAINT, INK
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import TIME, mark_phases
from scenarios.measures.clearance import Nearest, thing_name
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

LEFT, RIGHT, HEIGHT, LEGEND = 0.38, 0.11, 1.14, 0.50
BETWEEN = 0.44
"""Inches from the upper panel to the lower one, with the upper one's legend between them."""

LIMIT, BODY = (0, (4, 2)), ":"
FILTERED = ("decentralised", "centralised")
"""Filters that keep a clearance."""


def separation(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The smallest distance between two collision centres over time, its lowest point, and the limits.

    Where there are walls or obstacles, the smallest distances from these below it.
    """
    beside = metrics.clearance is not None
    lower = LEGEND + (HEIGHT + BETWEEN if beside else 0.0)
    figure = sheet(lower + HEIGHT + 0.21)
    axes = panel(figure, LEFT, lower, COLUMN - LEFT - RIGHT, HEIGHT)
    _draw_pairs(axes, experiment, trajectory, metrics)
    mark_phases(axes, experiment, names=True)
    if not beside:
        figure.legend(loc="lower center", ncols=3, bbox_to_anchor=(0.5, 0.04 / figure.get_figheight()))
        return figure
    below = panel(figure, LEFT, LEGEND, COLUMN - LEFT - RIGHT, HEIGHT, sharex=axes)
    _draw_clearance(below, experiment, trajectory, metrics)
    mark_phases(below, experiment)
    axes.set_xlabel("")
    axes.tick_params(labelbottom=False)
    axes.legend(loc="upper center", ncols=3, bbox_to_anchor=(0.5, -0.06 / HEIGHT))
    below.legend(loc="lower center", ncols=3, bbox_to_anchor=(0.5, (0.04 - LEGEND) / HEIGHT))
    figure.align_ylabels([axes, below])
    return figure


def _draw_pairs(axes: Axes, experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> None:
    t, distance = trajectory.t, metrics.separation.distance
    axes.plot(t, distance, color=INK, linewidth=0.9, label="closest pair")
    too_close = distance < COLLISION_DISTANCE
    axes.fill_between(t, distance, COLLISION_DISTANCE, where=too_close, color=ALARM, alpha=0.3, linewidth=0.0)
    axes.axhline(
        COLLISION_DISTANCE, color=ALARM, linewidth=0.7, linestyle=LIMIT,
        label=f"testbed's limit, {COLLISION_DISTANCE:g} m",
    )  # fmt: skip
    width = experiment.fleet.widest
    axes.axhline(width, color=INK, linewidth=0.6, linestyle=BODY, label=f"chassis width, {width:g} m")
    axes.set(xlim=(t[0], t[-1]), ylim=(0.0, 1.1 * np.nanmax(distance)), xlabel=TIME, ylabel="separation (m)")
    lowest = int(np.nanargmin(distance))
    pair = experiment.numbered(metrics.separation.pairs[lowest])
    _note(axes, t, distance, lowest, f"{distance[lowest]:.3f} m, agents {pair[0]} and {pair[1]}, {t[lowest]:.1f} s")


def _draw_clearance(axes: Axes, experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> None:
    if metrics.clearance is None:
        return
    t, points, hulls = trajectory.t, metrics.clearance.points, metrics.clearance.hulls
    axes.plot(t, points.distance, color=INK, linewidth=0.9, label="nearest projected point")
    top = 1.15 * float(np.nanmax(points.distance))
    if hulls is not None:
        axes.plot(t, hulls.distance, color=FAINT, linewidth=0.9, label="nearest hull", zorder=1.5)
        axes.fill_between(t, hulls.distance, 0.0, where=hulls.distance < 0.0, color=ALARM, alpha=0.3, linewidth=0.0)
    if experiment.safety in FILTERED:
        kept = experiment.filter_settings.clearance
        axes.axhline(kept, color=ALARM, linewidth=0.7, linestyle=LIMIT, label=f"the filter keeps {kept:g} m")
        top = max(top, 1.6 * kept)
    bottom = min(0.0, 0.0 if hulls is None else 1.1 * float(np.nanmin(hulls.distance)))
    axes.set(xlim=(t[0], t[-1]), ylim=(bottom, top), xlabel=TIME, ylabel="clearance (m)")
    axes.plot(t[points.lowest], points.distance[points.lowest], "o", color=INK, markersize=2.5, zorder=5)
    axes.set_title(_where(experiment, points, t), loc="right", fontsize=SMALL)
    if hulls is not None:
        axes.plot(t[hulls.lowest], hulls.distance[hulls.lowest], "o", color=FAINT, markersize=2.5, zorder=4)


def _where(experiment: Experiment, nearest: Nearest, t: Real) -> str:
    step = nearest.lowest
    who, thing = experiment.name(int(nearest.row[step])), thing_name(int(nearest.thing[step]))
    return f"{nearest.distance[step]:.3f} m, {who}, {thing}, {t[step]:.1f} s"


def _note(axes: Axes, t: Real, distance: Real, lowest: int, text: str) -> None:
    """Mark the lowest point of a curve, and say beside it what it is."""
    axes.plot(t[lowest], distance[lowest], "o", color=INK, markersize=2.5, zorder=5)
    right = t[lowest] < t[0] + 0.5 * (t[-1] - t[0])
    axes.annotate(
        text, (t[lowest], distance[lowest]), (4.0 if right else -4.0, -3.0), textcoords="offset points",
        fontsize=SMALL, ha="left" if right else "right", va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
    )  # fmt: skip
