"""What changes over time: angle errors, their sum, and the phases that they belong to."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import FAINT, INK, agent_colour
from scenarios.figures.style import SMALL
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

ALPHA = "\U0001d6fc"
TIME = "\U0001d461 (s)"
"""Mathematical italic letters."""

DASHES = ("-", "--", ":", "-.")
"""Line styles of the angles at one vertex, in their order."""

MOST_PHASES = 8
"""More phases than this are no parts of a figure."""

MANY = 12
"""More lines than this get no legend of their own."""


CROWD = 60
"""More angles than this are drawn as what they have in common."""

QUANTILES = (0.05, 0.5, 0.95)


def few_phases(experiment: Experiment) -> bool:
    """Whether phases are so few that each has its name, its snapshot and its panel."""
    return len(experiment.phases) <= MOST_PHASES


def mark_phases(axes: Axes, experiment: Experiment, names: bool = False) -> None:
    """A line at each boundary between few phases, and their names above the axes if ``names``."""
    if not few_phases(experiment):
        return
    ends = np.cumsum([phase.duration for phase in experiment.phases])
    for end in ends[:-1]:
        axes.axvline(end, color=INK, linewidth=0.5, linestyle=(0, (4, 2)), zorder=1)
    if names and len(ends) > 1:
        for phase, end in zip(experiment.phases, ends, strict=True):
            axes.text(
                end - phase.duration / 2.0, 1.03, phase.name, transform=axes.get_xaxis_transform(),
                fontsize=SMALL, ha="center", va="bottom",
            )  # fmt: skip


def draw_error_sum(axes: Axes, experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> None:
    """The sum of the absolute angle errors on a log axis, with the goal and the time of settling."""
    t = trajectory.t
    if experiment.plant != "single_integrator":  # which has no axles
        axes.semilogy(t, metrics.axle_error_sum, color=FAINT, linewidth=0.7, label="axle centres")
    axes.semilogy(t, metrics.error_sum, color=INK, linewidth=0.9, label="projected points")
    axes.axhline(experiment.goal, color=INK, linewidth=0.5, linestyle=":", label=f"goal, {experiment.goal:g} rad")
    if metrics.settling_time is not None:
        axes.plot([metrics.settling_time], [experiment.goal], "o", color=INK, markersize=2.5, zorder=5)
    bottom = experiment.goal * 1e-3
    top = np.nanmax([np.nanmax(metrics.error_sum), np.nanmax(metrics.axle_error_sum), experiment.goal])
    axes.set(xlim=(t[0], t[-1]), ylim=(bottom, 2.0 * top), ylabel="sum of |error| (rad)")
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())


def draw_errors(axes: Axes, experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> None:
    """Each angle error in the colour of its vertex, a line style for each angle at one vertex; of a crowd quantiles."""
    if len(experiment.angles) > CROWD:
        _draw_quantiles(axes, trajectory.t, np.abs(metrics.angle_errors), experiment.goal / len(experiment.angles))
        return
    seen: dict[int, int] = {}
    for column, (vertex, name) in enumerate(
        zip(experiment.angles.triples[:, 0].tolist(), experiment.angle_names, strict=True)
    ):
        style = DASHES[seen.setdefault(vertex, 0) % len(DASHES)]
        seen[vertex] += 1
        errors = unwrapped(metrics.angle_errors[:, column])
        axes.plot(
            trajectory.t, errors, color=agent_colour(vertex), linestyle=style,
            linewidth=0.8, label=written(name),
        )  # fmt: skip
    axes.axhline(0.0, color=FAINT, linewidth=0.4, zorder=0)
    axes.set(xlim=(trajectory.t[0], trajectory.t[-1]), xlabel=TIME, ylabel="angle error (rad)")


def _draw_quantiles(axes: Axes, t: Real, errors: Real, goal: float) -> None:
    """The median of the absolute errors (T, m), where nine of ten are, and the largest, on a log axis.

    Errors that all equal ``goal`` have a sum that just meets it.
    """
    low, middle, high = np.nanquantile(errors, QUANTILES, axis=1)
    axes.fill_between(t, low, high, color=FAINT, alpha=0.5, linewidth=0.0, label="nine of ten")
    axes.semilogy(t, middle, color=INK, linewidth=0.9, label="median")
    axes.semilogy(t, np.nanmax(errors, axis=1), color=INK, linewidth=0.6, linestyle="--", label="largest")
    axes.axhline(goal, color=INK, linewidth=0.5, linestyle=":")
    axes.set(xlim=(t[0], t[-1]), ylim=(1e-3 * goal, 2.0 * np.pi), xlabel=TIME, ylabel="|angle error| (rad)")
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())


def written(name: str) -> str:
    """An angle's name as a figure writes it; in Unicode, because mathematical markup costs 5 ms a name.

    >>> written("alpha(3;2,4)")
    '\U0001d6fc(3; 2, 4)'
    """
    return name.replace("alpha", ALPHA).replace(";", "; ").replace(",", ", ")


def unwrapped(errors: Real) -> Real:
    """Wrapped angles (T,), radians, with NaN after each jump between -pi and pi: no line across the axes."""
    broken = np.array(errors)
    broken[1:][np.abs(np.diff(errors)) > np.pi] = np.nan
    return broken
