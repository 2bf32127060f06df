"""The paper's second and third figure: where the robots go, and how their angle errors vanish."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from formation.plane import Complex, Real, as_complex, as_vectors
from scenarios.definition.events.event import SAME_TIME
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.figures.floor import Limits, draw_edges, draw_robots, draw_trails, limits, placed, prepare
from scenarios.figures.happenings import (
    BADGE_BELOW,
    BADGE_RADIUS,
    draw_passing,
    lasting,
    mark_places,
    mark_times,
    places,
    words_height,
    write_words,
)
from scenarios.figures.labels import Labels, points_per_metre
from scenarios.figures.palette import INK
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import CROWD, MANY, draw_error_sum, draw_errors, few_phases, mark_phases
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

LEFT, RIGHT = 0.44, 0.11
SUM_HEIGHT, EACH_HEIGHT, GAP = 0.72, 0.85, 0.14
TALLEST_FLOOR = 3.2
ABOVE_FLOOR, BELOW_FLOOR, ABOVE_ERRORS = 0.2, 0.34, 0.04
"""Inches; room for legends, and for the names and numbers of an axis."""

ROOM_FOR_TIMES = 0.04
"""Room above the highest robot, where snapshots are labelled with their times, as a share of the width."""

SNAPSHOTS = 3
"""States that are drawn of a motion that changes all the time, where there is room for them."""

CLEAR = 1.5
"""Least distance of two robots in two of them, in circles about a chassis."""

MOST_LOOKED_AT = 500
"""States among which they are chosen."""

FIRST_GREY, LAST_GREY = 0.82, 0.30
"""Edges of the snapshots, darker with time."""


def motion(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, at: Sequence[float] = ()) -> Figure:
    """Start, end of each phase and trajectories on the floor; sum of the angle errors and each of them over time.

    Args:
        experiment: of the run.
        trajectory: its states.
        metrics: what was measured of it.
        at: times, seconds, at which the robots are drawn instead.

    Raises:
        InputError: a time is not one of the run.
    """
    bottom = _height(experiment)
    rows, shown, size = _shown(experiment, trajectory, metrics, at)
    figure = sheet(bottom + size[1] + ABOVE_FLOOR)
    _floor(panel(figure, LEFT, bottom, *size), experiment, trajectory, rows, shown, bool(at))
    _timelines(figure, experiment, trajectory, metrics)
    return figure


def floor(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, at: Sequence[float] = ()) -> Figure:
    """The upper panel of :func:`motion` by itself: where the robots go."""
    rows, shown, size = _shown(experiment, trajectory, metrics, at)
    bottom = words_height(experiment) + BELOW_FLOOR
    figure = sheet(bottom + size[1] + ABOVE_FLOOR)
    _floor(panel(figure, LEFT, bottom, *size), experiment, trajectory, rows, shown, bool(at))
    write_words(figure, experiment)
    return figure


def errors(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """The lower panels of :func:`motion` by themselves: the angle errors over time."""
    figure = sheet(_height(experiment) - BELOW_FLOOR + ABOVE_ERRORS)
    _timelines(figure, experiment, trajectory, metrics)
    return figure


def _shown(
    experiment: Experiment, trajectory: Trajectory, metrics: Metrics, at: Sequence[float]
) -> tuple[list[int], Limits, tuple[float, float]]:
    """The states that are drawn, the part of the floor that is shown, and its width and height, inches."""
    rows = rows_at(trajectory, at) if at else snapshot_rows(experiment, trajectory, metrics)
    shown = limits(experiment.arena, trajectory.poses)
    if at or len(experiment.phases) > 1 or experiment.phases[0].reference is not None:
        shown = (*shown[:3], shown[3] + ROOM_FOR_TIMES * (shown[1] - shown[0]))
    width = COLUMN - LEFT - RIGHT
    height = width * (shown[3] - shown[2]) / (shown[1] - shown[0])
    if height > TALLEST_FLOOR:
        width, height = width * TALLEST_FLOOR / height, TALLEST_FLOOR
    return rows, shown, (width, height)


def _each(experiment: Experiment) -> float:
    """Inches below the panel of the errors, each by itself."""
    angles = len(experiment.angles)
    return words_height(experiment) + 0.34 + (0.11 * -(-angles // 4) + 0.05 if angles <= MANY else 0.14)


def _named_phases(experiment: Experiment) -> bool:
    return len(experiment.phases) > 1 and few_phases(experiment)


def _height(experiment: Experiment) -> float:
    """Inches below the floor where the errors are drawn under it."""
    above = 0.64 if _named_phases(experiment) else 0.52
    return _each(experiment) + EACH_HEIGHT + GAP + SUM_HEIGHT + above


def _timelines(figure: Figure, experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> None:
    words, named, each = words_height(experiment), len(experiment.angles) <= MANY, _each(experiment)
    lower = panel(figure, LEFT, each, COLUMN - LEFT - RIGHT, EACH_HEIGHT)
    upper = panel(figure, LEFT, each + EACH_HEIGHT + GAP, COLUMN - LEFT - RIGHT, SUM_HEIGHT, sharex=lower)
    draw_error_sum(upper, experiment, trajectory, metrics)
    draw_errors(lower, experiment, trajectory, metrics)
    mark_phases(upper, experiment, names=True)
    mark_phases(lower, experiment)
    mark_times(upper, experiment, numbers=True)
    mark_times(lower, experiment)
    write_words(figure, experiment)
    upper.tick_params(labelbottom=False)
    above = 1.20 if _named_phases(experiment) else 1.04
    upper.legend(loc="lower center", bbox_to_anchor=(0.5, above), ncols=3)
    if named:
        handles, names = lower.get_legend_handles_labels()
        figure.legend(
            handles, names, loc="lower center", ncols=4, bbox_to_anchor=(0.5, (words + 0.02) / figure.get_figheight())
        )
    else:
        drawn = "each in the colour of the agent at its vertex"
        if len(experiment.angles) > CROWD:
            drawn = "median (line), nine of ten (grey), largest (dashed)"
        text = f"{len(experiment.angles)} angles: {drawn}"
        figure.text(0.5, (words + 0.04) / figure.get_figheight(), text, fontsize=SMALL, ha="center", va="bottom")
    figure.align_ylabels([upper, lower])


def _floor(
    axes: Axes, experiment: Experiment, trajectory: Trajectory, rows: list[int], shown: Limits, timed: bool
) -> None:
    prepare(axes, lasting(experiment), shown)
    draw_passing(axes, experiment)
    few = experiment.n <= MANY
    draw_trails(axes, trajectory, 0.7 if few else 0.3)
    for row, grey in zip(rows, np.linspace(FIRST_GREY, LAST_GREY, len(rows)), strict=True):
        if few:
            draw_edges(axes, experiment.of_phase(trajectory.phase[row]).graph, trajectory.points[row], f"{grey:.3f}")
        draw_robots(axes, experiment, trajectory.poses[row], trajectory.points[row], hollow=row == 0)
    _label(axes, experiment, trajectory, rows, timed or len(rows) > 2)
    mark_places(axes, experiment, trajectory)
    start = Line2D([], [], linestyle="", marker="s", markersize=4, color=INK, markerfacecolor="white", label="start")
    filled = Line2D([], [], linestyle="", marker="s", markersize=4, color=INK, label=_filled(experiment, rows, timed))
    markers = [start] * (0 in rows) + [filled] * (rows != [0])
    axes.legend(handles=markers, loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=2)


def _filled(experiment: Experiment, rows: list[int], timed: bool) -> str:
    """What a filled robot stands for."""
    if timed:
        return "later" if 0 in rows else "on the way"
    if len(rows) == 2:
        return "end"
    return "end of a phase" if len(experiment.phases) > 1 and few_phases(experiment) else "on the way, end"


def rows_at(trajectory: Trajectory, at: Sequence[float]) -> list[int]:
    """Rows of the trajectory nearest to times, seconds, in their order; the last finite ones where it was cut.

    Raises:
        InputError: a time is not one of the run.
    """
    t = trajectory.t[np.isfinite(trajectory.poses).all(axis=(1, 2))]
    for time in at:
        if not 0.0 <= time <= t[-1] + SAME_TIME:
            raise InputError(f"--at: expected seconds of the run, 0 to {t[-1]:g}, got {time:g}")
    return sorted({int(np.abs(t - time).argmin()) for time in at})


def snapshot_rows(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> list[int]:
    """Rows of the trajectory that are drawn: the start, each phase's end, and the last finite state of a cut run.

    On a reference, or where phases are many, the start, the end, and what is farthest from these on the way.
    """
    last = int(np.flatnonzero(np.isfinite(trajectory.poses).all(axis=(1, 2)))[-1])
    if few_phases(experiment) and experiment.phases[0].reference is None:
        return sorted({0, *(end.row for end in metrics.phases), last})
    if experiment.n > MANY:
        return sorted({0, last})
    stride, rows = max(1, last // MOST_LOOKED_AT), [0, last]
    states = as_complex(trajectory.points[: last + 1 : stride])
    nearest = np.minimum(_nearest(states, states[0]), _nearest(states, as_complex(trajectory.points[last])))
    while len(rows) < SNAPSHOTS and nearest.max() > CLEAR * experiment.robot.chassis.radius:
        farthest = int(nearest.argmax())
        rows.append(stride * farthest)
        nearest = np.minimum(nearest, _nearest(states, states[farthest]))
    return sorted(set(rows))


def _nearest(places: Complex, state: Complex) -> Real:
    """(T,) how near any robot of the states (T, n) comes to any of another state (n,), metres."""
    return np.abs(places[..., None] - state).min(axis=(1, 2))


def _label(axes: Axes, experiment: Experiment, trajectory: Trajectory, rows: list[int], timed: bool) -> None:
    body = experiment.fleet.widest
    points = trajectory.points
    trails = points[:: max(1, len(points) // 200)]
    ends = points[rows][:, experiment.graph.formation_edges]
    along = np.linspace(0.0, 1.0, 12)[:, None, None, None]
    edges = ends[..., 0, :] * (1.0 - along) + ends[..., 1, :] * along
    corners = experiment.arena.corners
    outlines = [np.concatenate([corners, corners[:1]]), *(each.outline for each in experiment.arena.obstacles)]
    occupied = np.concatenate([trails.reshape(-1, 2), edges.reshape(-1, 2), *map(_along, outlines)])
    solid = np.concatenate([_cores(experiment, trajectory, rows), _badges(axes, experiment, trajectory)])
    labels = Labels(axes, occupied, solid)
    distance = 0.7 * body * points_per_metre(axes) + 3.5
    size = SMALL if experiment.n <= MANY else 4.5
    for row in dict.fromkeys((rows[-1], rows[0])) if experiment.n <= MANY else rows[-1:]:
        for agent in range(experiment.n):
            moved = np.linalg.norm(points[rows[-1], agent] - points[rows[0], agent])
            if row == rows[-1] or moved > body:
                labels.put(
                    points[row, agent], str(experiment.number(agent)), distance, size, crowded=experiment.n > MANY
                )
    if timed:
        for row, agent in zip(rows, _bearers(as_complex(points[rows]), CLEAR * body), strict=True):
            labels.put(points[row, agent], f"{round(trajectory.t[row], 1):g} s", distance + 1.0, SMALL + 0.5)


def _bearers(states: Complex, clear: float) -> list[int]:
    """Of each state (s, n), the agent that bears its time: the highest that is clear of all robots of other states."""
    found = []
    for index, state in enumerate(states):
        others = np.delete(states, index, axis=0).reshape(-1, 1)
        apart = np.minimum(np.abs(others - state).min(axis=0, initial=np.inf), clear)
        found.append(int(np.lexsort([state.imag, apart])[-1]))
    return found


def _cores(experiment: Experiment, trajectory: Trajectory, rows: list[int]) -> Real:
    """(q, 2) points along the inner half of each robot, metres: its own number may be near its hull."""
    if experiment.plant == "single_integrator":
        return trajectory.points[rows].reshape(-1, 2)
    hulls = experiment.fleet.outlines
    halves = (hulls + hulls.mean(axis=1, keepdims=True)) / 2.0
    closed = np.concatenate([halves, halves[:, :1]], axis=1)
    return np.concatenate([_along(core)[::4] for row in rows for core in placed(closed, trajectory.poses[row])])


def _badges(axes: Axes, experiment: Experiment, trajectory: Trajectory) -> Real:
    """(q, 2) points round the numbers of events, and where these happen, metres."""
    ring = BADGE_RADIUS * np.exp(2j * np.pi * np.arange(8) / 8) - 1j * BADGE_BELOW
    around = as_vectors(np.append(ring, [-1j * BADGE_BELOW, 0.0])) / points_per_metre(axes)
    found = [place + around for _, place in places(experiment, trajectory)]
    return np.concatenate([np.empty((0, 2)), *found])


def _along(outline: Real) -> Real:
    """(q, 2) points along a closed outline (m, 2), so near to each other that no label fits between them."""
    share = np.linspace(0.0, 1.0, 24)[:, None, None]
    return np.asarray(outline[:-1] + share * np.diff(outline, axis=0)).reshape(-1, 2)
