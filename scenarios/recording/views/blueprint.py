"""The layouts: made to be read at a glance at 1400 x 800, playing at 1x."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import rerun.blueprint as rrb

from formation import fit_similarity, wrap
from robots import ROBOTARIUM_FLOOR
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import predicted_ends
from scenarios.recording.piece import Real
from scenarios.recording.recorder import TIMELINE
from scenarios.recording.views import angles, legend, plots, scene, style, summary, timeline

Span = tuple[float, float]

MARGIN_SHARE = 0.06
"""The same as a share of the longer side, for a floor on which :data:`MARGIN` is too little to write in."""

REACH = 3.0
"""Metres beyond floor, start and predicted ends that a run may widen the view: a run that diverges has no limits."""

WIDE = 2.0
"""Times the area of what happens from which a floor is shown in part."""

FAR = 1.5
"""Times that robots are larger in the view from near by, from which it is in front."""

LOG_RANGE = (-14.0, 1.5)
"""Decades that logarithmic plots show."""

FIGURES = {
    plots.ANGLES: "Angle errors (rad)",
    plots.ERROR_SUM: "log10 of angle error sum",
    plots.SEPARATION: "Closest pair (m)",
    plots.WHEELS: "Wheels (rad/s), limits red",
    plots.SCALE: "Scale",
    plots.ORIENTATION: "Orientation (deg)",
    plots.CENTROID: "Centroid (m)",
    plots.DISTANCE: "log10 distance to predicted",
}
"""Plots and their titles."""

BESIDE = {plots.CLEARANCE: "Walls (m)"}
"""How near a point and a hull come to walls and obstacles, behind the summary; tabs have room for short words."""

LEGEND_BESIDE = {plots.CLEARANCE: rrb.Corner2D.RightBottom}

FILTER = {plots.INTERVENTIONS: "Filter (m/s)"}
"""What the safety filter changes, behind the summary."""

SHARED = {
    plots.ERROR_SUM: "log10 of angle error sum",
    plots.SEPARATION: "Closest pair (m), limit red",
    plots.SCALE: "Scale, predicted grey",
    plots.ORIENTATION: "Orientation (deg)",
}
"""Plots in which two runs share the axes; the title of each arena tells its run's colour."""


def single(experiment: Experiment, points: Real, live: bool = False) -> rrb.Blueprint:
    """The layout for one run whose projected points are (T, n, 2), metres; a live one follows the newest data."""
    crowd = experiment.n > style.CROWD
    left = rrb.Vertical(
        scenery(experiment, points),
        rrb.Horizontal(states([""], length(experiment)), notes(experiment, ""), column_shares=[0.75, 1.0]),
        row_shares=[2.2 if crowd else 1.85, 1.0],
    )
    absent = set()
    if experiment.plant == "single_integrator":
        absent.add(plots.WHEELS)
    if not experiment.predicted:
        absent.add(plots.DISTANCE)
    shown = {entity: name for entity, name in FIGURES.items() if entity not in absent}
    span = spans(experiment, points)
    right = figures([""], shown, length(experiment), span, plots.corners(experiment, points, span))
    beside = rrb.Grid(*right, grid_columns=2)
    return _layout(
        rrb.Horizontal(left, beside, column_shares=[1.6 if crowd else 1.35, 1.0]), "following" if live else "playing"
    )


def pair(
    experiments: Sequence[Experiment], points: Sequence[Real], roots: Sequence[str], names: Sequence[str]
) -> rrb.Blueprint:
    """The layout for two runs: their arenas side by side, their curves in shared axes."""
    seconds = max(length(experiment) for experiment in experiments)
    arenas = [arena(*each) for each in zip(experiments, points, roots, names, strict=True)]
    both = [spans(experiment, each) for experiment, each in zip(experiments, points, strict=True)]
    span = {entity: (min(s[entity][0] for s in both), max(s[entity][1] for s in both)) for entity in both[0]}
    shared = rrb.Grid(*figures(roots, SHARED, seconds, span), grid_columns=len(SHARED))
    texts = [
        rrb.Horizontal(states([root], seconds), notes(experiment, root))
        for experiment, root in zip(experiments, roots, strict=True)
    ]
    return _layout(
        rrb.Vertical(rrb.Horizontal(*arenas), shared, rrb.Horizontal(*texts), row_shares=[1.6, 0.9, 1.3]), "playing"
    )


def scenery(experiment: Experiment, points: Real) -> rrb.Spatial2DView | rrb.Tabs:
    """The arena, and behind it the same from near by: with each angle in words, and going with the formation.

    What is near is in front where robots would be that much larger: for a formation that leaves, or a wide floor.
    """
    half = scene.near(experiment, points)
    near = _spatial(
        "", f"/{scene.CAMERA}", "Near by, moving along", (-half[0], half[0]), (-half[1], half[1]), words=True
    )
    (left, bottom), (right, top) = bounds(experiment, points)
    far = min((right - left) / (2.0 * half[0]), (top - bottom) / (2.0 * half[1])) > FAR
    return rrb.Tabs(arena(experiment, points, "", "Arena (m)"), near, active_tab=1 if far else 0)


def arena(experiment: Experiment, points: Real, root: str, name: str) -> rrb.Spatial2DView:
    """The robots on their floor, with everything that happens in sight."""
    (x0, y0), (x1, y1) = bounds(experiment, points)
    return _spatial(root, _path(root, scene.VIEW), name, (x0, x1), (-y1, -y0))


def bounds(experiment: Experiment, points: Real) -> tuple[Real, Real]:
    """The lower left and the upper right corner of what happens, metres; of a floor that is far wider, a part."""
    start = points.reshape(-1, experiment.n, 2)[0]
    known = np.concatenate([start, predicted_ends(experiment, start).reshape(-1, 2)])
    low, high = known.min(axis=0), known.max(axis=0)
    seen = points[np.isfinite(points).all(axis=-1)].clip(low - REACH, high + REACH)
    known = np.concatenate([known, seen, ROBOTARIUM_FLOOR.corners])
    low, high = known.min(axis=0), known.max(axis=0)
    floor = experiment.arena.corners
    if np.prod(np.ptp(floor, axis=0)) < WIDE * np.prod(high - low):
        low, high = np.minimum(low, floor.min(axis=0)), np.maximum(high, floor.max(axis=0))
    margin = max(style.MARGIN, MARGIN_SHARE * float((high - low).max()))
    return low - margin, high + margin


def _spatial(root: str, origin: str, name: str, x: Span, y: Span, words: bool = False) -> rrb.Spatial2DView:
    """A view of the arena; with the angles in words, or with each robot's range."""
    trail = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-style.TRAIL_LENGTH),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    still = rrb.EntityBehavior(interactive=False)
    return rrb.Spatial2DView(
        origin=origin,
        contents=_below([root], scene.VIEW) + ([] if words else [f"- {_path(root, angles.WORDS)}"]),
        name=name,
        visual_bounds=rrb.VisualBounds2D(x_range=x, y_range=y),
        background=rrb.Background(color=style.BACKGROUND),
        overrides={_path(root, scene.TRAILS): trail, **{_path(root, entity): still for entity in scene.BACKDROP}},
    )


def states(roots: Sequence[str], seconds: float) -> rrb.StateTimelineView:
    """What is the case, over the whole run."""
    return rrb.StateTimelineView(
        contents=[each for lane in timeline.LANES for each in _below(roots, lane)],
        name="States",
        time_view=rrb.TimeAxis(view_range=_times(seconds)),
    )


def notes(experiment: Experiment, root: str) -> rrb.Tabs:
    """The summary page, the events, how near walls and obstacles are, and what the safety filter changes."""
    bounded = experiment.arena.walls or bool(experiment.arena.obstacles)
    return rrb.Tabs(
        rrb.TextDocumentView(origin=_path(root, summary.SUMMARY), name="Summary"),
        rrb.TextDocumentView(origin=_path(root, legend.LEGEND), name="Legend"),
        rrb.TextLogView(
            origin=_path(root, timeline.EVENTS),
            name="Events",
            columns=rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["loglevel", "body"]),
        ),
        *(figures([root], BESIDE, length(experiment), {}, LEGEND_BESIDE) if bounded else []),
        *(figures([root], FILTER, length(experiment), {}) if experiment.safety != "none" else []),
        active_tab="Summary",
    )


def figures(
    roots: Sequence[str],
    shown: dict[str, str],
    seconds: float,
    span: dict[str, Span],
    legends: dict[str, rrb.Corner2D] | None = None,
) -> list[rrb.TimeSeriesView]:
    """Plots by entity and title, with all runs below ``roots`` in one set of axes."""
    return [
        rrb.TimeSeriesView(
            contents=_below(roots, entity),
            name=name,
            axis_x=rrb.TimeAxis(view_range=_times(seconds * plots.TIME_MARGIN)),
            axis_y=rrb.ScalarAxis(range=span[entity]) if entity in span else None,
            plot_legend=rrb.PlotLegend(corner=(legends or {}).get(entity), visible=entity in (legends or {})),
        )
        for entity, name in shown.items()
    ]


def spans(experiment: Experiment, points: Real) -> dict[str, Span]:
    """The plots' ranges that the viewer would choose too tight for labels, by entity."""
    states = points.reshape(-1, experiment.n, 2)
    ends = predicted_ends(experiment, states[0])
    seen = states[np.isfinite(states).all(axis=(1, 2))]
    scale, angle, _ = fit_similarity(experiment.formation, np.concatenate([seen, ends]))
    largest = min(scale.max(), 3.0 * max(scale[0], scale[-len(ends) :].max()))
    quarters = np.degrees(wrap(angle)) / 90.0
    low, high = np.floor(quarters.min()), np.ceil(quarters.max())
    beyond = 1.0 if high - low == 4.0 else 0.0  # the curve goes on across the half turn
    return {
        plots.ERROR_SUM: LOG_RANGE,
        plots.DISTANCE: LOG_RANGE,
        plots.SCALE: (-0.1 * largest, 1.1 * largest),
        plots.ORIENTATION: (90.0 * (low - beyond) - 18.0, 90.0 * (high + beyond) + 18.0),
    }


def length(experiment: Experiment) -> float:
    """Planned length of a run, seconds."""
    return sum(phase.duration for phase in experiment.phases)


def _path(root: str, entity: str) -> str:
    return f"/{root}/{entity}" if root else f"/{entity}"


def _below(roots: Sequence[str], entity: str) -> list[str]:
    return [f"+ {_path(root, entity)}/**" for root in roots]


def _times(seconds: float) -> rrb.TimeRange:
    start, end = (rrb.TimeRangeBoundary.absolute(seconds=t) for t in (0.0, seconds))
    return rrb.TimeRange(start=start, end=end)


def _layout(container: rrb.Container, play: Literal["playing", "following"]) -> rrb.Blueprint:
    return rrb.Blueprint(
        container,
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state=play, playback_speed=1.0),
    )
