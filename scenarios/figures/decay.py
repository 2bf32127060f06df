"""Predicted beside measured decay: how each follower nears its place, phase by phase (Theorem 1)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from formation import agents, decay_rates, end_configuration
from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import INK, agent_colour
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import MANY, TIME
from scenarios.measures.metrics import Metrics
from scenarios.measures.tracking import predicted_ends, predicted_late_rates
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

NEAREST = 1e-6
"""Metres; what lies below is left out of the figure."""

NOTEWORTHY = 1e-3
"""Metres."""

PANEL, GAP, LEFT, RIGHT = 1.05, 0.34, 0.44, 0.11
COLUMNS = 4
GUIDE_ABOVE = 4.0
DASHED = (0, (3.0, 1.5))


def decay(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The distance of each follower from its place beside exp(-sin^2(a_k) t), one panel per phase."""
    indices = np.unique(trajectory.phase).tolist()
    rates = decay_rates(experiment.target)
    handles = _legend(experiment, rates)
    bottom = 0.40 + 0.105 * -(-len(handles) // COLUMNS)
    figure = sheet(bottom + len(indices) * (PANEL + GAP) - 0.12)
    for place, index in enumerate(reversed(indices)):
        axes = panel(figure, LEFT, bottom + place * (PANEL + GAP), COLUMN - LEFT - RIGHT, PANEL)
        _draw_phase(axes, experiment, trajectory, index, rates)
        if len(indices) > 1:
            title = f"{experiment.phases[index].name}, from {trajectory.t[_rows(trajectory, index)[0]]:g} s"
            axes.set_title(title, loc="left")
        if place == 0:
            axes.set_xlabel("time since the start of the phase (s)" if len(indices) > 1 else TIME)
    figure.legend(
        handles=handles, loc="lower center", ncols=COLUMNS, bbox_to_anchor=(0.5, 0.03 / figure.get_figheight())
    )
    return figure


def _legend(experiment: Experiment, rates: Real) -> list[Line2D]:
    handles = [
        Line2D([], [], color=INK, linewidth=0.9, label="measured"),
        Line2D([], [], color=INK, linewidth=0.6, linestyle=DASHED, label=r"$\exp(-\sin^2\!\alpha_k\,t)$"),
    ]
    if (slowest := _slowest(experiment)) is not None:
        handles.append(Line2D([], [], color=INK, linewidth=0.8, linestyle=":", label=f"late, {slowest:.2f} /s"))
    if len(rates) <= MANY:
        for row, rate in zip(experiment.target.graph.followers.tolist(), rates.tolist(), strict=True):
            text = f"agent {agents.number(row)}, {rate:.2f} /s"
            handles.append(Line2D([], [], color=agent_colour(row), linewidth=1.4, label=text))
    return handles


def _slowest(experiment: Experiment) -> float | None:
    """The rate, 1/s, that the slowest cascade comes down to in the end."""
    rates = predicted_late_rates(experiment)
    return None if rates is None else float(rates.min())


def _rows(trajectory: Trajectory, index: int) -> NDArray[np.intp]:
    """Rows of a phase that are finite, from the state at which it starts."""
    rows = np.flatnonzero(trajectory.phase == index)
    if rows[0] > 0:
        rows = np.insert(rows, 0, rows[0] - 1)
    return rows[np.isfinite(trajectory.points[rows]).all(axis=(1, 2))]


def places(experiment: Experiment, trajectory: Trajectory, index: int) -> Real:
    """(T', n, 2) where each agent of a phase should be, at the phase's start and after each of its periods, metres.

    The leader and the first follower alone fix the places, so where they are at the end of the phase decides, carried
    back with v_r: contact may have pushed them from where they were predicted.
    """
    rows = _rows(trajectory, index)
    leader, first = trajectory.points[rows[-1], : agents.FIRST_ORDINARY]
    end = end_configuration(experiment.formation, leader, first)
    ahead = (trajectory.t[rows[-1]] - trajectory.t[rows])[:, None] * np.array(experiment.phases[index].velocity)
    return end - ahead[:, None, :]


def _draw_phase(axes: Axes, experiment: Experiment, trajectory: Trajectory, index: int, rates: Real) -> None:
    rows = _rows(trajectory, index)
    t = trajectory.t[rows] - trajectory.t[rows[0]]
    distances = np.linalg.norm(trajectory.points[rows] - places(experiment, trajectory, index), axis=-1)
    for row, rate in zip(experiment.target.graph.followers.tolist(), rates.tolist(), strict=True):
        axes.semilogy(t, distances[:, row], color=agent_colour(row), linewidth=0.9, label=f"measured {row}")
        predicted = distances[0, row] * np.exp(-rate * t)
        axes.semilogy(t, predicted, color=agent_colour(row), linewidth=0.6, linestyle=DASHED, label=f"predicted {row}")
    followers = distances[:, agents.FIRST_ORDINARY :].max(axis=1)
    near = np.flatnonzero(followers < NEAREST)
    until = t[near[0]] if near.size else t[-1]
    axes.set(xlim=(0.0, max(until, t[-1] * 0.1)), ylim=(NEAREST, 2.5 * followers.max()), ylabel="distance (m)")
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    if (slowest := _slowest(experiment)) is not None:
        _guide(axes, t, distances[:, agents.FIRST_ORDINARY :].max(axis=1), slowest)
    _note_push(axes, experiment, trajectory, index)


def _guide(axes: Axes, t: Real, farthest: Real, rate: float) -> None:
    """A line of the late rate, clear above the lower half of the measured curves, to compare their slope with."""
    middle = np.sqrt(farthest[0] * max(NEAREST, farthest.min()))
    below = np.flatnonzero(farthest < middle)
    if below.size:
        begin = below[0]
        axes.semilogy(
            t[begin:], GUIDE_ABOVE * farthest[begin] * np.exp(-rate * (t[begin:] - t[begin])),
            color=INK, linewidth=0.8, linestyle=":", label="late rate",
        )  # fmt: skip


def _note_push(axes: Axes, experiment: Experiment, trajectory: Trajectory, index: int) -> None:
    """Say how far agents 1 and 2 end from where they were predicted."""
    row = _rows(trajectory, index)[-1]
    predicted = predicted_ends(experiment, trajectory.points[0])[index]
    ahead = sum(phase.duration for phase in experiment.phases[: index + 1]) - trajectory.t[row]
    predicted = predicted - ahead * np.array(experiment.phases[index].velocity)
    pushed = np.linalg.norm(trajectory.points[row] - predicted, axis=-1)[: agents.FIRST_ORDINARY]
    if pushed.max() > NOTEWORTHY:
        text = f"agents 1, 2 end {1e3 * pushed[0]:.0f} mm, {1e3 * pushed[1]:.0f} mm off prediction"
        axes.set_title(text, loc="right", fontsize=SMALL)
