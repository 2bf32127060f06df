"""Predicted beside measured decay: how each follower nears its place, phase by phase (Theorem 1).

The dashed lines are the exact solution of the closed loop from the phase's first state: ideal agents, whose commands
are held over a control period where the plant holds them, with neither wheels' limits nor a filter.
"""

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
from scenarios.figures.timelines import MANY, TIME, few_phases
from scenarios.measures.late_rates import predicted_late_rates
from scenarios.measures.metrics import Metrics
from scenarios.measures.predictions.theory import motion, moves_exactly
from scenarios.measures.tracking import moving_ends, placed
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

NEAREST = 1e-6
"""Metres; what lies below is left out of the figure."""

FARTHEST = 1e12
"""Metres; the curves of a run that diverges leave the figure there, before their squares are no numbers."""

NOTEWORTHY = 1e-3
"""Metres."""

PANEL, GAP, LEFT, RIGHT = 1.05, 0.34, 0.44, 0.11
COLUMNS = 4
GUIDE_ABOVE = 4.0
DASHED = (0, (3.0, 1.5))


def decay(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The distance of each follower from its place beside the exact solution, one panel per phase."""
    if not few_phases(experiment):
        return _whole(experiment, trajectory, metrics)
    indices = np.unique(trajectory.phase).tolist()
    slowest = _slowest(experiment, trajectory)
    handles = _legend(experiment, slowest)
    bottom = 0.40 + 0.105 * -(-len(handles) // COLUMNS)
    figure = sheet(bottom + len(indices) * (PANEL + GAP) - 0.12)
    for place, index in enumerate(reversed(indices)):
        axes = panel(figure, LEFT, bottom + place * (PANEL + GAP), COLUMN - LEFT - RIGHT, PANEL)
        _draw_phase(axes, experiment, trajectory, index, slowest if place == 0 else None)
        if len(indices) > 1:
            title = f"{experiment.phases[index].name}, from {trajectory.t[_rows(trajectory, index)[0]]:g} s"
            axes.set_title(title, loc="left")
        if place == 0:
            axes.set_xlabel("time since the start of the phase (s)" if len(indices) > 1 else TIME)
    figure.legend(
        handles=handles, loc="lower center", ncols=COLUMNS, bbox_to_anchor=(0.5, 0.03 / figure.get_figheight())
    )
    return figure


def _whole(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """One panel over the whole run, of phases too many for one each: distances from the moving place (Theorem 2)."""
    handles = [handle for handle in _legend(experiment, None) if handle.get_label() != "exact solution"]
    bottom = 0.40 + 0.105 * -(-len(handles) // COLUMNS)
    figure = sheet(bottom + PANEL + GAP - 0.12)
    axes = panel(figure, LEFT, bottom, COLUMN - LEFT - RIGHT, PANEL)
    distances = metrics.tracking.distances
    for row in experiment.target.graph.followers.tolist():
        axes.semilogy(trajectory.t, distances[:, row], color=agent_colour(row), linewidth=0.9)
    far = np.nanmax(distances[:, agents.FIRST_ORDINARY :])
    axes.set(xlim=(0.0, trajectory.t[-1]), ylim=(NEAREST, 2.5 * far), ylabel="distance (m)", xlabel=TIME)
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_title(f"{len(experiment.phases)} phases", loc="left")
    figure.legend(
        handles=handles, loc="lower center", ncols=COLUMNS, bbox_to_anchor=(0.5, 0.03 / figure.get_figheight())
    )
    return figure


def _legend(experiment: Experiment, slowest: float | None) -> list[Line2D]:
    handles = [Line2D([], [], color=INK, linewidth=0.9, label="measured")]
    if moves_exactly(experiment):
        handles.append(Line2D([], [], color=INK, linewidth=0.6, linestyle=DASHED, label="exact solution"))
    if slowest is not None:
        handles.append(Line2D([], [], color=INK, linewidth=0.8, linestyle=":", label=f"late, {slowest:.2f} /s"))
    if experiment.n - agents.FIRST_ORDINARY <= MANY:
        rates = decay_rates(experiment.target) * (1.0 if experiment.own_gains is None else experiment.own_gains)
        for row, rate in zip(experiment.target.graph.followers.tolist(), rates.tolist(), strict=True):
            text = experiment.name(row) if experiment.shapes else f"{experiment.name(row)}, {rate:.2f} /s"
            handles.append(Line2D([], [], color=agent_colour(row), linewidth=1.4, label=text))
    return handles


def _slowest(experiment: Experiment, trajectory: Trajectory) -> float | None:
    """The rate, 1/s, predicted of the follower that is the slowest to come down in the last phase."""
    rates = [rate for rate in predicted_late_rates(experiment, trajectory) or [] if rate is not None]
    return min(rates) if rates else None


def _rows(trajectory: Trajectory, index: int) -> NDArray[np.intp]:
    """Rows of a phase that are finite, from the state at which it starts."""
    rows = np.flatnonzero(trajectory.phase == index)
    if rows[0] > 0:
        rows = np.insert(rows, 0, rows[0] - 1)
    return rows[np.isfinite(trajectory.points[rows]).all(axis=(1, 2))]


def places(experiment: Experiment, trajectory: Trajectory, index: int) -> Real:
    """(T', n, 2) where each agent of a phase should be, at the phase's start and after each of its periods, metres.

    The leader and the first follower alone fix the places, so where they are at the end of the phase decides, carried
    back with v_r: contact may have pushed them from where they were predicted. On a reference they have no end, and
    where they are at the moment decides.
    """
    rows = _rows(trajectory, index)
    return _where(experiment, index, trajectory.t[rows], trajectory.points[rows])


def _where(experiment: Experiment, index: int, t: Real, points: Real) -> Real:
    """The same of states (T', n, 2), metres, measured or exact, of a phase at times t (T',), seconds."""
    if experiment.phases[index].reference is not None:
        return placed(experiment, points)
    leader, first = points[-1, : agents.FIRST_ORDINARY]
    end = end_configuration(experiment.of_phase(index).formation, leader, first)
    ahead = (t[-1] - t)[:, None] * np.array(experiment.phases[index].velocity)
    return end - ahead[:, None, :]


def _draw_phase(axes: Axes, experiment: Experiment, trajectory: Trajectory, index: int, late: float | None) -> None:
    rows = _rows(trajectory, index)
    t = trajectory.t[rows] - trajectory.t[rows[0]]
    where = places(experiment, trajectory, index)
    distances = np.linalg.norm(trajectory.points[rows] - where, axis=-1)
    exact = None
    if moves_exactly(experiment):
        ideal = motion(experiment, trajectory.points[rows[0]], index)[: len(rows)]
        exact = np.linalg.norm(ideal - _where(experiment, index, t, ideal), axis=-1)
    for row in experiment.target.graph.followers.tolist():
        axes.semilogy(t, distances[:, row], color=agent_colour(row), linewidth=0.9, label=f"measured {row}")
        if exact is not None:
            axes.semilogy(
                t, exact[:, row], color=agent_colour(row), linewidth=0.6, linestyle=DASHED, label=f"predicted {row}"
            )
    farthest = distances[:, agents.FIRST_ORDINARY :].max(axis=1)
    far = np.flatnonzero(farthest >= NEAREST)
    until = t[min(far[-1] + 1, len(t) - 1)] if far.size else 0.0
    top = float(np.fmin(2.5 * farthest.max(), FARTHEST))
    axes.set(xlim=(0.0, max(until, t[-1] * 0.1)), ylim=(NEAREST, top), ylabel="distance (m)")
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    if late is not None:
        _guide(axes, t, farthest, late)
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
    when, phase = trajectory.t[row : row + 1], trajectory.phase[row : row + 1]
    predicted = moving_ends(experiment, trajectory.points[0], when, phase)[0]
    pushed = np.linalg.norm(trajectory.points[row] - predicted, axis=-1)[: agents.FIRST_ORDINARY]
    if pushed.max() > NOTEWORTHY:
        text = f"agents 1, 2 end {1e3 * pushed[0]:.0f} mm, {1e3 * pushed[1]:.0f} mm off prediction"
        axes.set_title(text, loc="right", fontsize=SMALL)
