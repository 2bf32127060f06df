"""The paper's first figure: who senses whom, and the shape that is wanted."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import INK, agent_colour
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import MANY
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

TINT = 0.30
"""Share of the agent's colour in the face of its node; the rest is white, so that the number stays legible."""

SIDE = 1.38
"""Inches; the side of either panel."""


def graph(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The sensing graph G_s beside the target formation (G_f, p*) with the edges that it adds."""
    figure = sheet(2.16)
    left = panel(figure, 0.06, 0.50, SIDE, SIDE)
    right = panel(figure, COLUMN - 0.08 - SIDE, 0.50, SIDE, SIDE)
    positions = experiment.formation.positions
    size = _node_size(positions)
    width = 0.7 if experiment.n <= MANY else 0.3
    for axes in (left, right):
        _frame(axes, positions)
    for observer, observed in experiment.graph.edges:
        left.add_patch(_arrow(positions[observer], positions[observed], size, width))
    segments = positions[experiment.graph.formation_edges]
    sensed = len(experiment.graph.edges)
    right.add_collection(LineCollection(list(segments[:sensed]), colors=INK, linewidths=width, zorder=1))
    added = LineCollection(list(segments[sensed:]), colors=INK, linewidths=width, linestyles=[(0, (4, 2))], zorder=1)
    right.add_collection(added)
    for axes in (left, right):
        _nodes(axes, experiment, positions, size)
    left.set_axis_off()
    left.set_title("(a) sensing graph", pad=5.0)
    right.set_title("(b) target formation", pad=5.0)
    right.set(xlabel="\U0001d465 (m)", ylabel="\U0001d466 (m)")
    right.locator_params(nbins=5)
    for spine in ("top", "right"):
        right.spines[spine].set_visible(False)
    text = "an arrow points from an agent\nto one whose place it measures"
    left.text(0.5, -0.06, text, transform=left.transAxes, fontsize=SMALL, ha="center", va="top", linespacing=1.1)
    handles = [
        Line2D([], [], color=INK, linewidth=0.7, label="sensed"),
        Line2D([], [], color=INK, linewidth=0.7, linestyle=(0, (4, 2)), label="added"),
    ]
    shown = handles[: 1 + (len(segments) > sensed)]
    below = (1.0 - (0.08 + SIDE / 2.0) / COLUMN, 0.04 / figure.get_figheight())
    figure.legend(handles=shown, loc="lower center", ncols=2, bbox_to_anchor=below)
    return figure


def _node_size(positions: Real) -> float:
    """Diameter of a node, points: smaller for many agents, and never so large that two nodes touch."""
    span = np.ptp(positions, axis=0).max()
    gaps = np.linalg.norm(positions[:, None] - positions[None, :], axis=-1)
    np.fill_diagonal(gaps, np.inf)
    nearest = gaps.min() / (1.3 * span) * SIDE * 72.0
    return float(np.clip(0.8 * nearest, 3.0, 11.0))


def _frame(axes: Axes, positions: Real) -> None:
    """Square limits with room for the nodes."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    centre, half = (low + high) / 2.0, 0.65 * float((high - low).max())
    axes.set(xlim=(centre[0] - half, centre[0] + half), ylim=(centre[1] - half, centre[1] + half), aspect="equal")


def _arrow(tail: Real, head: Real, node: float, width: float) -> FancyArrowPatch:
    gap = node / 2.0 + 0.6
    return FancyArrowPatch(
        tuple(tail),
        tuple(head),
        arrowstyle="-|>,head_length=0.38,head_width=0.16",
        mutation_scale=max(node, 5.0),
        shrinkA=gap,
        shrinkB=gap,
        linewidth=width,
        color=INK,
        joinstyle="miter",
        zorder=2,
    )


def _nodes(axes: Axes, experiment: Experiment, positions: Real, size: float) -> None:
    edges = [to_rgb(agent_colour(row)) for row in range(len(positions))]
    faces = [tuple(1.0 - TINT * (1.0 - c) for c in edge) for edge in edges]
    axes.scatter(
        positions[:, 0], positions[:, 1], s=size**2, facecolors=faces, edgecolors=edges, linewidths=0.9, zorder=3
    )
    if len(positions) > MANY:
        return
    for row, (x, y) in enumerate(positions):
        axes.text(x, y, str(experiment.number(row)), fontsize=SMALL, ha="center", va="center_baseline", zorder=4)
