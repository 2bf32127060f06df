"""How close the robots come to each other, against what the testbed allows."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from robots.testbed import COLLISION_DISTANCE
from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import ALARM, INK
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import TIME, mark_phases
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

LEFT, RIGHT = 0.38, 0.11


def separation(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The smallest distance between two collision centres over time, its lowest point, and the limits."""
    figure = sheet(1.85)
    axes = panel(figure, LEFT, 0.50, COLUMN - LEFT - RIGHT, 1.14)
    t, distance = trajectory.t, metrics.separation.distance
    axes.plot(t, distance, color=INK, linewidth=0.9, label="closest pair")
    too_close = distance < COLLISION_DISTANCE
    axes.fill_between(t, distance, COLLISION_DISTANCE, where=too_close, color=ALARM, alpha=0.3, linewidth=0.0)
    axes.axhline(
        COLLISION_DISTANCE, color=ALARM, linewidth=0.7, linestyle=(0, (4, 2)),
        label=f"testbed's limit, {COLLISION_DISTANCE:g} m",
    )  # fmt: skip
    width = experiment.robot.chassis.width
    axes.axhline(width, color=INK, linewidth=0.6, linestyle=":", label=f"chassis width, {width:g} m")
    lowest = int(np.nanargmin(distance))
    pair = experiment.numbered(metrics.separation.pairs[lowest])
    axes.plot(t[lowest], distance[lowest], "o", color=INK, markersize=2.5, zorder=5)
    axes.set(xlim=(t[0], t[-1]), ylim=(0.0, 1.1 * np.nanmax(distance)), xlabel=TIME, ylabel="separation (m)")
    mark_phases(axes, experiment, names=True)
    right = t[lowest] < t[0] + 0.6 * (t[-1] - t[0])
    axes.annotate(
        f"{distance[lowest]:.3f} m, agents {pair[0]} and {pair[1]}, {t[lowest]:.1f} s",
        (t[lowest], distance[lowest]), (4.0 if right else -4.0, -3.0), textcoords="offset points",
        fontsize=SMALL, ha="left" if right else "right", va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
    )  # fmt: skip
    figure.legend(loc="lower center", ncols=3, bbox_to_anchor=(0.5, 0.04 / figure.get_figheight()))
    return figure
