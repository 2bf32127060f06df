"""What happens on the way, in figures: spans and numbers over time, numbers on the floor, a line of words for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from robots import Arena
from scenarios.definition.events.event import Event
from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import INK, agent_colour
from scenarios.figures.style import SMALL
from scenarios.simulation.outages import whereabouts
from scenarios.simulation.trajectory import Trajectory

LINE = 0.115
"""Inches of a line of words."""

MOST_LINES = 8
"""Events that are written out; more are counted."""

FRESH = 3.0
"""Seconds for which a film tells of what is over at once."""

SPAN = "#F3E3C3"
"""Colour of the time that an event lasts."""

BADGE_BELOW, BADGE_RADIUS = 12.0, 4.5
"""Points from the place of an event down to its number, and about how large that is."""

BADGE = {"boxstyle": "circle,pad=0.18", "facecolor": "white", "linewidth": 0.6}


def shown(experiment: Experiment) -> list[Event]:
    """The events that begin within the run."""
    length = sum(phase.duration for phase in experiment.phases)
    return [event for event in experiment.events if event.begin < length]


def mark_times(axes: Axes, experiment: Experiment, numbers: bool = False) -> None:
    """A line where each event begins, a span where it ends within the run; its number on top if ``numbers``."""
    length = sum(phase.duration for phase in experiment.phases)
    heights: dict[float, int] = {}
    for event in shown(experiment):
        if event.begin < event.end < np.inf:
            axes.axvspan(event.begin, min(event.end, length), color=SPAN, linewidth=0.0, alpha=0.7, zorder=0.5)
        axes.axvline(event.begin, color=_colour(event), linewidth=0.8, zorder=1.5)
        if numbers:
            level = heights[event.begin] = heights.get(event.begin, -1) + 1
            axes.annotate(
                str(event.number), (event.begin, 1.0), (4.5 + 8.0 * level, -6.0), textcoords="offset points",
                xycoords=axes.get_xaxis_transform(), fontsize=SMALL - 1.0, ha="center", va="center",
                bbox=BADGE | {"edgecolor": _colour(event)}, zorder=6,
            )  # fmt: skip


def lasting(experiment: Experiment) -> Arena:
    """The floor without the obstacles that events place."""
    passing = [event.obstacle for event in experiment.events]
    here = tuple(each for each in experiment.arena.obstacles if not any(each is other for other in passing))
    return replace(experiment.arena, obstacles=here)


def draw_passing(axes: Axes, experiment: Experiment) -> list[tuple[Event, Polygon]]:
    """The obstacles that events place within the run, dashed, as each is there for a while only."""
    drawn = []
    for event in shown(experiment):
        if event.obstacle is not None:
            patch = Polygon(event.obstacle.outline, facecolor=SPAN, edgecolor=INK, linewidth=0.5, zorder=1)
            patch.set_linestyle((0, (3, 2)))
            axes.add_patch(patch)
            drawn.append((event, patch))
    return drawn


def places(experiment: Experiment, trajectory: Trajectory) -> Iterator[tuple[Event, tuple[float, float]]]:
    """The events that happen somewhere, and where, metres."""
    for event in shown(experiment):
        if event.begin < trajectory.t[-1] and (place := whereabouts(event, trajectory)) is not None:
            yield event, (float(place[0]), float(place[1]))


def mark_places(axes: Axes, experiment: Experiment, trajectory: Trajectory) -> None:
    """The number of each event where it happens, if it happens somewhere."""
    for event, place in places(experiment, trajectory):
        axes.plot(*place, "x", color=_colour(event), markersize=4.0, markeredgewidth=1.0, zorder=6)
        axes.annotate(
            str(event.number), place, (0.0, -BADGE_BELOW), textcoords="offset points", fontsize=SMALL - 1.0,
            ha="center", va="center", bbox=BADGE | {"edgecolor": _colour(event)}, zorder=7,
            arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": INK, "shrinkA": 0.0, "shrinkB": 1.0},
        )  # fmt: skip


def words_height(experiment: Experiment) -> float:
    """Inches that :func:`write_words` needs."""
    count = len(shown(experiment))
    return LINE * min(count, MOST_LINES + 1) + 0.05 if count else 0.0


def write_words(figure: Figure, experiment: Experiment) -> None:
    """A line for each event, from the figure's lower edge up."""
    events = shown(experiment)
    lines = [f"{event.number}  at {event.begin:g} s: {event.what}" for event in events[:MOST_LINES]]
    if len(events) > MOST_LINES:
        lines.append(f"and {len(events) - MOST_LINES} more")
    height = figure.get_figheight()
    for place, line in enumerate(reversed(lines)):
        figure.text(0.5, (0.03 + LINE * place) / height, line, fontsize=SMALL, ha="center", va="bottom")


def news(experiment: Experiment, t: float) -> str:
    """A line for each event that is on at a time, seconds, or has been for no more than :data:`FRESH`."""
    fresh = [event for event in experiment.events if event.lasts(t) or event.begin <= t < event.begin + FRESH]
    return "\n".join(f"{event.number}  {event.what}" for event in fresh)


def _colour(event: Event) -> str:
    return INK if event.row is None else agent_colour(event.row)
