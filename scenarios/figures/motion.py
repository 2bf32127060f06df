"""The paper's second and third figure: where the robots go, and how their angle errors vanish."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from formation.plane import Complex, Real, as_complex
from scenarios.definition.experiment import Experiment
from scenarios.figures.floor import Limits, draw_edges, draw_robots, draw_trails, limits, prepare
from scenarios.figures.happenings import mark_places, mark_times, words_height, write_words
from scenarios.figures.labels import Labels, points_per_metre
from scenarios.figures.palette import INK
from scenarios.figures.style import COLUMN, SMALL, panel, sheet
from scenarios.figures.timelines import MANY, draw_error_sum, draw_errors, few_phases, mark_phases
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory

LEFT, RIGHT = 0.44, 0.11
SUM_HEIGHT, EACH_HEIGHT, GAP = 0.72, 0.85, 0.14
TALLEST_FLOOR = 3.2
"""Inches."""

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


def motion(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Figure:
    """Start, end of each phase and trajectories on the floor; sum of the angle errors and each of them over time."""
    shown = limits(experiment.arena, trajectory.poses)
    timed = len(experiment.phases) > 1 or experiment.phases[0].reference is not None
    if timed:
        shown = (*shown[:3], shown[3] + ROOM_FOR_TIMES * (shown[1] - shown[0]))
    width = COLUMN - LEFT - RIGHT
    height = width * (shown[3] - shown[2]) / (shown[1] - shown[0])
    if height > TALLEST_FLOOR:
        width, height = width * TALLEST_FLOOR / height, TALLEST_FLOOR
    named = len(experiment.angles) <= MANY
    words = words_height(experiment)
    legend = words + (0.11 * -(-len(experiment.angles) // 4) + 0.05 if named else 0.14)
    each = 0.34 + legend
    sums = each + EACH_HEIGHT + GAP
    named_phases = len(experiment.phases) > 1 and few_phases(experiment)
    floor = sums + SUM_HEIGHT + (0.64 if named_phases else 0.52)
    figure = sheet(floor + height + 0.2)
    _floor(panel(figure, LEFT, floor, width, height), experiment, trajectory, metrics, shown)
    lower = panel(figure, LEFT, each, COLUMN - LEFT - RIGHT, EACH_HEIGHT)
    upper = panel(figure, LEFT, sums, COLUMN - LEFT - RIGHT, SUM_HEIGHT, sharex=lower)
    draw_error_sum(upper, experiment, trajectory, metrics)
    draw_errors(lower, experiment, trajectory, metrics)
    mark_phases(upper, experiment, names=True)
    mark_phases(lower, experiment)
    mark_times(upper, experiment, numbers=True)
    mark_times(lower, experiment)
    write_words(figure, experiment)
    upper.tick_params(labelbottom=False)
    above = 1.20 if named_phases else 1.04
    upper.legend(loc="lower center", bbox_to_anchor=(0.5, above), ncols=3)
    if named:
        handles, names = lower.get_legend_handles_labels()
        figure.legend(
            handles, names, loc="lower center", ncols=4, bbox_to_anchor=(0.5, (words + 0.02) / figure.get_figheight())
        )
    else:
        text = f"{len(experiment.angles)} angles, each in the colour of the agent at its vertex"
        figure.text(0.5, (words + 0.04) / figure.get_figheight(), text, fontsize=SMALL, ha="center", va="bottom")
    figure.align_ylabels([upper, lower])
    return figure


def _floor(axes: Axes, experiment: Experiment, trajectory: Trajectory, metrics: Metrics, shown: Limits) -> None:
    prepare(axes, experiment.arena, shown)
    few = experiment.n <= MANY
    draw_trails(axes, trajectory, 0.7 if few else 0.3)
    rows = snapshot_rows(experiment, trajectory, metrics)
    for row, grey in zip(rows, np.linspace(FIRST_GREY, LAST_GREY, len(rows)), strict=True):
        if few:
            draw_edges(axes, experiment.of_phase(trajectory.phase[row]).graph, trajectory.points[row], f"{grey:.3f}")
        draw_robots(axes, experiment, trajectory.poses[row], trajectory.points[row], hollow=row == 0)
    _label(axes, experiment, trajectory, rows)
    mark_places(axes, experiment, trajectory)
    markers = [
        Line2D([], [], linestyle="", marker="s", markersize=4, color=INK, markerfacecolor="white", label="start"),
        Line2D(
            [],
            [],
            linestyle="",
            marker="s",
            markersize=4,
            color=INK,
            label=_filled(experiment, rows),
        ),
    ]
    axes.legend(handles=markers, loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=2)


def _filled(experiment: Experiment, rows: list[int]) -> str:
    """What a filled robot stands for."""
    if len(rows) == 2:
        return "end"
    return "end of a phase" if len(experiment.phases) > 1 and few_phases(experiment) else "on the way, end"


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
    places = as_complex(trajectory.points[: last + 1 : stride])
    nearest = np.minimum(_nearest(places, places[0]), _nearest(places, as_complex(trajectory.points[last])))
    while len(rows) < SNAPSHOTS and nearest.max() > CLEAR * experiment.robot.chassis.radius:
        farthest = int(nearest.argmax())
        rows.append(stride * farthest)
        nearest = np.minimum(nearest, _nearest(places, places[farthest]))
    return sorted(set(rows))


def _nearest(places: Complex, state: Complex) -> Real:
    """(T,) how near any robot of the states (T, n) comes to any of another state (n,), metres."""
    return np.abs(places[..., None] - state).min(axis=(1, 2))


def _label(axes: Axes, experiment: Experiment, trajectory: Trajectory, rows: list[int]) -> None:
    body = experiment.fleet.widest
    points = trajectory.points
    trails = points[:: max(1, len(points) // 200)]
    ends = points[rows][:, experiment.graph.formation_edges]
    along = np.linspace(0.0, 1.0, 12)[:, None, None, None]
    edges = ends[..., 0, :] * (1.0 - along) + ends[..., 1, :] * along
    things = [_along(obstacle.outline) for obstacle in experiment.arena.obstacles]
    labels = Labels(axes, np.concatenate([trails.reshape(-1, 2), edges.reshape(-1, 2), *things]))
    distance = 0.7 * body * points_per_metre(axes) + 3.5
    size = SMALL if experiment.n <= MANY else 4.5
    for row in (rows[-1], rows[0]) if experiment.n <= MANY else rows[-1:]:
        for agent in range(experiment.n):
            moved = np.linalg.norm(points[rows[-1], agent] - points[rows[0], agent])
            if row == rows[-1] or moved > body:
                labels.put(
                    points[row, agent], str(experiment.number(agent)), distance, size, crowded=experiment.n > MANY
                )
    if len(rows) > 2:
        for row in rows:
            highest = points[row, points[row, :, 1].argmax()]
            labels.put(highest, f"{round(trajectory.t[row], 1):g} s", distance + 1.0, SMALL + 0.5)


def _along(outline: Real) -> Real:
    """(q, 2) points along a closed outline (m, 2), so near to each other that no label fits between them."""
    share = np.linspace(0.0, 1.0, 24)[:, None, None]
    return np.asarray(outline[:-1] + share * np.diff(outline, axis=0)).reshape(-1, 2)
