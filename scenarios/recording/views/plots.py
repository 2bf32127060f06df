"""Scalars over time, and their legends: angle errors, wheel speeds, separation, and how the maneuver is tracked.

Scalars are float64: a recording has exactly the numbers of ``trajectory.npz``.
"""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from formation import fit_similarity, wrap
from robots.testbed import COLLISION_DISTANCE
from robots.testbed import separation as closest
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import fits, moving_ends, predicted_ends
from scenarios.recording.piece import Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import style
from scenarios.recording.views.style import Colour

ANGLES, ERROR_SUM, SEPARATION = "errors/angles", "errors/log10_sum", "separation"
WHEELS, INTERVENTIONS, CLEARANCE = "wheels", "interventions", "clearance"
SCALE, ORIENTATION, CENTROID = "tracking/scale", "tracking/orientation", "tracking/centroid"
DISTANCE = "tracking/log10_distance"

TIME_MARGIN = 1.08
"""Length of the plots' time axis over the run's, so that its last label has room."""

MOST_IN_LEGEND = 4
"""Curves above which a legend hides what it explains: their colours are those of the agents in the arena."""

LEGEND_SHARE, LEGEND_STATES = (0.42, 0.5), 120
"""Width and height of a legend over its plot's, and states of a run from which it sees where curves are."""

LEVEL = 0.3
"""What a level stretch of a curve tells over what an upright one of the same length does."""

SMALLEST = 1e-16
"""Radians or metres; what is smaller is drawn here, as its logarithm may not exist."""


def styles(recorder: Recorder, experiment: Experiment) -> None:
    """Names and colours of all series. What belongs to one agent has its colour."""
    vertices = experiment.angles.triples[:, 0]
    _style(recorder, f"{ANGLES}/value", experiment.angle_names, [style.agent_colour(row) for row in vertices])
    _style(recorder, f"{ERROR_SUM}/value", ["sum of |error|"], [recorder.colour])
    _style(recorder, f"{ERROR_SUM}/goal", ["goal"], [style.GOAL])
    _style(recorder, f"{SEPARATION}/value", ["closest pair"], [recorder.colour])
    _style(recorder, f"{SEPARATION}/limit", ["testbed's limit"], [style.LIMIT])
    _style(recorder, f"{CLEARANCE}/value", ["nearest point", "nearest hull"], [recorder.colour, style.SECOND])
    _style(recorder, f"{CLEARANCE}/limit", ["filter's clearance"], [style.LIMIT])
    names = [f"{experiment.number(row)} {side}" for row in range(experiment.n) for side in ("left", "right")]
    _style(recorder, f"{WHEELS}/value", names, [style.agent_colour(row // 2) for row in range(2 * experiment.n)])
    _style(recorder, f"{WHEELS}/limit", ["limit", "limit"], [style.LIMIT] * 2)
    for entity in (SCALE, ORIENTATION):
        _style(recorder, f"{entity}/ideal", ["predicted"], [style.PREDICTED], 3.0)
        _style(recorder, f"{entity}/measured", ["measured"], [recorder.colour])
    _style(recorder, f"{CENTROID}/ideal", ["predicted"] * 2, [style.PREDICTED] * 2, 3.0)
    _style(recorder, f"{CENTROID}/measured", ["x", "y"], [style.MEASURED, style.SECOND])
    rows = range(experiment.n)
    for entity in (DISTANCE, INTERVENTIONS):
        numbers = [experiment.name(row) for row in rows]
        _style(recorder, f"{entity}/value", numbers, [style.agent_colour(row) for row in rows])


def angle_errors(recorder: Recorder, piece: Piece) -> None:
    """Each angle error, radians."""
    _wrapped(recorder, f"{ANGLES}/value", piece.t, piece.angle_errors, 2.0 * np.pi)


def error_sum(recorder: Recorder, piece: Piece) -> None:
    """log10 of the absolute sum of the angle errors, and of the goal."""
    _series(recorder, f"{ERROR_SUM}/value", piece.t, np.log10(np.maximum(piece.error_sum, SMALLEST)))
    _level(recorder, f"{ERROR_SUM}/goal", piece, [np.log10(piece.experiment.goal)])


def wheel_speeds(recorder: Recorder, piece: Piece) -> None:
    """Left and right wheel of each robot between their limits, rad/s; nothing for a plant without wheels."""
    if np.isnan(piece.trajectory.wheel_speeds[-1]).all():
        return
    speeds = piece.trajectory.wheel_speeds
    _series(recorder, f"{WHEELS}/value", piece.t, speeds.reshape(len(speeds), -1))
    limit = float(np.max(piece.experiment.fleet.drive.wheel_speed_limit))
    _level(recorder, f"{WHEELS}/limit", piece, [-limit, limit])


def separation(recorder: Recorder, piece: Piece) -> None:
    """Distance of the closest pair of collision centres and the distance that the testbed demands, metres."""
    _series(recorder, f"{SEPARATION}/value", piece.t, piece.separation.distance)
    _level(recorder, f"{SEPARATION}/limit", piece, [COLLISION_DISTANCE])


def clearance(recorder: Recorder, piece: Piece) -> None:
    """Smallest distance of a projected point and of a hull from walls and obstacles, metres; nothing without these."""
    if piece.clearance is None:
        return
    points, hulls = piece.clearance.points, piece.clearance.hulls
    both = [points.distance] if hulls is None else [points.distance, hulls.distance]
    _series(recorder, f"{CLEARANCE}/value", piece.t, np.stack(both, axis=-1))
    if piece.experiment.safety != "none":
        _level(recorder, f"{CLEARANCE}/limit", piece, [piece.experiment.filter_settings.clearance])


def interventions(recorder: Recorder, piece: Piece) -> None:
    """How far the safety filter moved each agent's velocity, m/s; nothing without a filter."""
    if piece.experiment.safety != "none":
        _series(recorder, f"{INTERVENTIONS}/value", piece.t, piece.trajectory.intervention)


def tracking(recorder: Recorder, piece: Piece) -> None:
    """Scale, orientation (degrees) and centroid (metres) of the formation and of the moving end of Theorem 2.

    Beside them, log10 of each agent's distance (metres) from its place in that end. Of an own law, what is measured.
    """
    experiment, points = piece.experiment, piece.trajectory.points
    wanted = moving_ends(experiment, piece.start, piece.t, piece.trajectory.phase)
    scale, angle, centroid = fits(experiment, piece.trajectory.phase, points)
    scale_0, angle_0, centroid_0 = fits(experiment, piece.trajectory.phase, wanted)
    angle_0 = wrap(angle_0)
    for entity, measured, predicted in ((SCALE, scale, scale_0), (CENTROID, centroid, centroid_0)):
        if experiment.predicted:
            _series(recorder, f"{entity}/ideal", piece.t, predicted)
        _series(recorder, f"{entity}/measured", piece.t, measured)
    if experiment.predicted:
        _wrapped(recorder, f"{ORIENTATION}/ideal", piece.t, np.degrees(angle_0), 360.0)
    _wrapped(recorder, f"{ORIENTATION}/measured", piece.t, np.degrees(angle_0 + wrap(angle - angle_0)), 360.0)
    if not experiment.predicted:
        return
    distance = np.linalg.norm(points - wanted, axis=-1)
    _series(recorder, f"{DISTANCE}/value", piece.t, np.log10(np.maximum(distance, SMALLEST)))


def corners(experiment: Experiment, points: Real, span: dict[str, tuple[float, float]]) -> dict[str, rrb.Corner2D]:
    """Where the legends of plots stand, by entity: in the corner in which each hides least of its curves.

    Args:
        experiment: what is run.
        points: (T, n, 2) projected points, metres.
        span: least and largest value shown, by entity; what is not in it shows all of its curves.
    """
    states = points.reshape(-1, experiment.n, 2)
    rows = np.flatnonzero(np.isfinite(states).all(axis=(1, 2)))
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, LEGEND_STATES, dtype=np.intp))]
    x, seen = rows / (TIME_MARGIN * max(len(states) - 1, 1)), states[rows]
    scale, angle, _ = fit_similarity(experiment.formation, seen)
    gap = closest(seen).distance if experiment.n <= style.CROWD else np.array([])
    curves = {
        SEPARATION: (gap, [COLLISION_DISTANCE], rrb.Corner2D.RightBottom),
        SCALE: (scale, [], rrb.Corner2D.RightBottom),
        ORIENTATION: (np.degrees(wrap(angle)), [], rrb.Corner2D.RightTop),
        CENTROID: (seen.mean(axis=1), predicted_ends(experiment, states[0]).mean(axis=1), rrb.Corner2D.RightTop),
    }
    found = {ERROR_SUM: rrb.Corner2D.LeftBottom}  # it begins on the left, at the top
    for entity, (values, others, first) in curves.items():
        known = np.append(values, others)
        low, high = span.get(entity, (known.min(), known.max()))
        y = (values.reshape(len(x), values.size // len(x)).T - low) / max(high - low, SMALLEST)
        told = LEVEL * np.diff(x, prepend=0.0) + np.abs(np.diff(y, prepend=y[:, :1]))
        found[entity] = min((first, *CORNERS), key=lambda corner: float(told[_hidden(corner, x, y)].sum()))
    if len(experiment.angles) <= MOST_IN_LEGEND:
        found[ANGLES] = rrb.Corner2D.RightTop
    return found


CORNERS = (rrb.Corner2D.RightTop, rrb.Corner2D.RightBottom, rrb.Corner2D.LeftTop, rrb.Corner2D.LeftBottom)


def _hidden(corner: rrb.Corner2D, x: Real, y: Real) -> NDArray[np.bool_]:
    """Which places of a plot, from 0 to 1 to the right and up, a legend hides."""
    width, height = LEGEND_SHARE
    right, top = corner in CORNERS[:2], corner in CORNERS[::2]
    return (x > 1.0 - width if right else x < width) & (y > 1.0 - height if top else y < height)


def _series(recorder: Recorder, entity: str, t: Real, values: Real) -> None:
    recorder.columns(entity, t, rr.Scalars.columns(scalars=values))


def _wrapped(recorder: Recorder, entity: str, t: Real, values: Real, turn: float) -> None:
    """Series that jump by a ``turn``: a gap in the middle of each jump, where the viewer would draw a spike."""
    values = values.reshape(len(t), -1)
    jumps = np.abs(np.diff(values, axis=0)) > turn / 2.0
    rows = np.flatnonzero(jumps.any(axis=1))
    between = (values[rows] + values[rows + 1]) / 2.0
    between[jumps[rows]] = np.nan
    t = np.insert(t, rows + 1, (t[rows] + t[rows + 1]) / 2.0)
    _series(recorder, entity, t, np.insert(values, rows + 1, between, axis=0))


def _level(recorder: Recorder, entity: str, piece: Piece, values: list[float]) -> None:
    """Levels that do not change: two rows draw the line."""
    _series(recorder, entity, piece.t[[0, -1]], np.tile(values, (2, 1)))


def _style(recorder: Recorder, entity: str, names: list[str], colours: list[Colour], width: float = 1.5) -> None:
    recorder.fixed(entity, rr.SeriesLines(colors=colours, names=names, widths=[width] * len(names)))
