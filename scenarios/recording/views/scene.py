"""The arena: floor, robots as oriented bodies, what they sense, where they came from and where the theory sends them.

Everything lies below one entity that mirrors y, because the viewer's second axis points down and ours up.
"""

# Longer than 300 lines: one entity has all that is drawn on the floor, in one order.

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from robots import ROBOTARIUM_FLOOR, Arena, RobotModel
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import following, predicted_ends
from scenarios.recording.piece import Index, Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import style
from scenarios.simulation.outages import lost_edges

Single = NDArray[np.float32]

VIEW = "arena"
WORLD, CAMERA = f"{VIEW}/world", f"{VIEW}/camera"
ROBOTS = f"{WORLD}/robots"
SENSING = f"{WORLD}/sensing"
TRAILS = f"{WORLD}/trails"
PREDICTION = f"{WORLD}/prediction"
FLOOR, TESTBED, GRID, TICKS = f"{WORLD}/floor", f"{WORLD}/testbed", f"{WORLD}/grid", f"{WORLD}/ticks"
BACKDROP = (FLOOR, TESTBED, GRID, TICKS)
"""What the pointer passes over in silence."""

RING = 0.04
"""Radius of the ring at a predicted place, metres."""

GHOST_PERIODS = 10
"""Control periods between two places of a ghost that moves."""

DOT = 3.5
"""Radius of a robot's dot in a crowd, points of the screen."""

MOSTLY = 0.9
"""Share of the run in which the camera that goes with the formation has all of it in sight."""

MARK, MARK_CORNERS = 0.038, (4, 3)
"""Radius, metres, of the marks on leader and first follower, and their corners: a diamond and a triangle."""

FILL = 0.01
"""Half the width of the strokes that fill a chassis, metres."""

UP = np.diag([1.0, -1.0, 1.0])
"""From y up to the viewer's y down."""


def floor(recorder: Recorder, experiment: Experiment) -> None:
    """The ground of the experiment's arena."""
    ground(recorder, experiment.arena)


def ground(recorder: Recorder, arena: Arena) -> None:
    """The arena's floor and walls with a labelled grid, and the Robotarium's floor where it is another one."""
    recorder.fixed(WORLD, rr.Transform3D(mat3x3=UP))
    recorder.fixed(
        FLOOR,
        rr.LineStrips2D(
            _closed(arena.corners),
            colors=style.WALL if arena.walls else style.FLOOR,
            radii=0.012 if arena.walls else 0.004,
            draw_order=-20.0,
        ),
    )
    if (arena.x, arena.y) != (ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y):
        recorder.fixed(
            TESTBED,
            rr.LineStrips2D(_closed(ROBOTARIUM_FLOOR.corners), colors=style.FLOOR, radii=0.004, draw_order=-21.0),
        )
    longest = max(arena.x[1] - arena.x[0], arena.y[1] - arena.y[0])
    step = next((step for step in style.GRID_STEPS if longest / step <= style.GRID_LINES), longest)
    x, y = _multiples(arena.x, step), _multiples(arena.y, step)
    across = [[[value, arena.y[0]], [value, arena.y[1]]] for value in x]
    along = [[[arena.x[0], value], [arena.x[1], value]] for value in y]
    recorder.fixed(
        GRID,
        rr.LineStrips2D(np.array(across + along, dtype=np.float32), colors=style.GRID, radii=0.002, draw_order=-30.0),
    )
    recorder.fixed(TICKS, _ticks(arena, x, y))


def bodies(recorder: Recorder, experiment: Experiment) -> None:
    """The body of each robot, with its number; leader and first follower with a mark and a word.

    In a crowd only these two have words, and a dot of the screen's own size shows where each robot is.
    """
    names = [str(experiment.number(row)) for row in range(experiment.n)]
    crowd, fleet = experiment.n > style.CROWD, experiment.fleet
    points, words = points_ahead(experiment), labels(experiment)
    for row, (body, point) in enumerate(zip(fleet.bodies, points, strict=True)):
        draw_bodies(recorder, RobotModel(fleet.drive, body), point, [names[row]], [words[row]], crowd, row)
    for row, corners in zip(range(len(roles(experiment))), MARK_CORNERS, strict=False):
        turn = 2.0 * np.pi * np.arange(corners + 1) / corners
        mark = MARK * np.stack([np.cos(turn), np.sin(turn)], axis=-1) + [points[row], 0.0]
        strip = rr.LineStrips2D(mark[None].astype(np.float32), colors=style.SECOND, radii=0.005, draw_order=11.5)
        recorder.fixed(f"{ROBOTS}/{names[row]}/mark", strip)


def labels(experiment: Experiment) -> list[str]:
    """What stands beside each robot: its number, and its role; in a crowd nothing where it has none."""
    names = [str(experiment.number(row)) for row in range(experiment.n)]
    words = [f"{name} {role}" for name, role in zip(names, roles(experiment), strict=False)]
    return words + [("" if experiment.n > style.CROWD else name) for name in names[len(words) :]]


def points_ahead(experiment: Experiment) -> list[float]:
    """Metres from each robot's axle to its projected point."""
    ahead: list[float] = np.broadcast_to(experiment.fleet.nid.projection_distance, experiment.n).tolist()
    return ahead


def roles(experiment: Experiment) -> tuple[str, ...]:
    """What agents 1, 2, ... are called where not all are alike."""
    return ("leader", "first follower") if experiment.aim.target is not None and experiment.predicted else ()


def draw_bodies(
    recorder: Recorder,
    robot: RobotModel,
    point: float,
    names: Sequence[str],
    labels: Sequence[str] | None = None,
    dots: bool = False,
    first: int = 0,
) -> None:
    """Chassis, wheels, nose and name of each robot, in the frame of its axle's centre, which is ``point`` behind it.

    Beside the projected point stands a robot's label, by default its name; ``dots`` are as large from near and far.
    ``first`` is the row of the first robot, by which they are coloured.
    """
    fill, outline, wheels = _body(robot)
    nose = [[point, 0.0]]
    for row, (name, label) in enumerate(zip(names, labels or names, strict=True), start=first):
        colour, entity = style.agent_colour(row), f"{ROBOTS}/{name}"
        paint = style.tint(colour, 0.3)
        recorder.fixed(f"{entity}/fill", rr.LineStrips2D(fill, colors=paint, radii=FILL, draw_order=9.0))
        recorder.fixed(f"{entity}/outline", rr.LineStrips2D(outline, colors=colour, radii=0.005, draw_order=10.0))
        recorder.fixed(f"{entity}/wheels", rr.LineStrips2D(wheels, colors=style.WHEEL, radii=0.009, draw_order=11.0))
        recorder.fixed(
            f"{entity}/point",
            rr.Points2D(
                nose,
                colors=colour if dots else style.TEXT,
                radii=rr.Radius.ui_points(DOT) if dots else 0.012,
                labels=label or None,
                show_labels=True,
                draw_order=12.0,
            ),
        )


def poses(recorder: Recorder, piece: Piece) -> None:
    """Where each robot is and where it points."""
    names = [str(piece.experiment.number(row)) for row in range(piece.experiment.n)]
    move_bodies(recorder, piece.t, piece.trajectory.poses, names)


def move_bodies(recorder: Recorder, t: Real, poses: Real, names: Sequence[str]) -> None:
    """Where robots with these names are at times t (T,): poses (T, n, 3)."""
    rows = _finite(poses)
    states = poses[rows].swapaxes(0, 1)
    translation = np.zeros(states.shape)
    translation[..., :2] = states[..., :2]
    half = states[..., 2] / 2.0
    turn = np.zeros((*half.shape, 4))
    turn[..., 2], turn[..., 3] = np.sin(half), np.cos(half)
    for row, name in enumerate(names):
        place = rr.Transform3D.columns(translation=translation[row], quaternion=turn[row])
        recorder.columns(f"{ROBOTS}/{name}", t[rows], place)


def sensing(recorder: Recorder, piece: Piece) -> None:
    """An arrow from each observer to each agent that it measures, along the line between their projected points.

    It leaves out what the two bodies cover.
    """
    for experiment, rows in _by_shape(piece, _finite(piece.trajectory.points)):
        _arrows(recorder, piece, experiment.graph.edges, rows)


def _by_shape(piece: Piece, rows: Index) -> list[tuple[Experiment, Index]]:
    """Rows of a piece with the experiment whose shape they have; all at once where the shape never changes."""
    if not piece.experiment.shapes:
        return [(piece.experiment, rows)]
    phase = piece.trajectory.phase[rows]
    return [(piece.experiment.of_phase(index), rows[phase == index]) for index in np.unique(phase).tolist()]


def _arrows(recorder: Recorder, piece: Piece, edges: Index, rows: Index) -> None:
    observer, observed = edges.T
    points = piece.trajectory.points[rows]
    e = points[:, observed] - points[:, observer]
    length = np.linalg.norm(e, axis=-1, keepdims=True)
    inset = np.minimum(style.ARROW_INSET / np.maximum(length, 1e-9), 0.5)
    if piece.experiment.events:
        inset = np.where(_lost(piece, rows, len(edges))[..., None], 0.5, inset)  # an arrow without length
    origins, vectors = points[:, observer] + inset * e, (1.0 - 2.0 * inset) * e
    recorder.columns(SENSING, piece.t[rows], rr.Arrows2D.columns(origins=origins, vectors=vectors))


def _lost(piece: Piece, rows: Index, m: int) -> NDArray[np.bool_]:
    """(T', m) which of the m edges of the graph an event has taken, at rows of the piece."""
    states = zip(piece.t[rows].tolist(), piece.trajectory.phase[rows].tolist(), strict=True)
    return np.array([lost_edges(piece.experiment, t, index)[:m] for t, index in states]).reshape(-1, m)


def sensing_style(recorder: Recorder, experiment: Experiment) -> None:
    """Thin and behind the robots."""
    m, crowd = len(experiment.graph.edges), experiment.n > style.CROWD
    colour = style.GHOST if crowd else style.SENSING
    radii = np.full(m, rr.Radius.ui_points(0.5) if crowd else 0.006, dtype=np.float32)
    recorder.fixed(SENSING, rr.Arrows2D.from_fields(colors=[colour] * m, radii=radii, draw_order=5.0))


def trails(recorder: Recorder, piece: Piece) -> None:
    """The path of each projected point."""
    draw_trails(recorder, piece.t, piece.trajectory.points)


def draw_trails(recorder: Recorder, t: Real, points: Real) -> None:
    """Paths of points (T, n, 2), as one short segment per robot and time; the view shows the latest ones."""
    rows = _finite(points)
    if len(rows) < 2:
        return
    stride = max(1, round(style.TRAIL_STEP / float(t[rows[1]] - t[rows[0]])))
    rows = np.unique(np.append(rows[::stride], rows[-1]))
    seen = points[rows]
    recorder.columns(TRAILS, t[rows[1:]], _strips(np.stack([seen[:-1], seen[1:]], axis=2)))


def trails_style(recorder: Recorder, experiment: Experiment) -> None:
    """Each in a shade of its agent's colour."""
    shade_trails(recorder, experiment.n)


def shade_trails(recorder: Recorder, n: int) -> None:
    """Paths of n robots, each in a shade of its colour."""
    shades = [style.tint(style.agent_colour(row), 0.55) for row in range(n)]
    recorder.fixed(TRAILS, rr.LineStrips2D.from_fields(colors=shades, radii=[0.004] * n, draw_order=3.0))


def prediction(recorder: Recorder, piece: Piece) -> None:
    """Where theory sees the phase under way end, as a ghost, which moves on a reference; none for an own law."""
    if not piece.experiment.predicted:
        return
    if piece.experiment.phases[0].reference is None:
        rows = piece.changes(piece.trajectory.phase)
        ends = predicted_ends(piece.experiment, piece.start)[piece.trajectory.phase[rows]]
    else:
        rows = np.arange(0, len(piece.t), GHOST_PERIODS)
        ends = following(piece.experiment, piece.start, piece.t[rows])
    turn = np.linspace(0.0, 2.0 * np.pi, 25)
    rings = ends[:, :, None] + RING * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    t = piece.t[np.maximum(rows - 1, 0)]
    recorder.columns(f"{PREDICTION}/rings", t, _strips(rings))
    if piece.experiment.n > style.CROWD:
        return
    for experiment, some in _by_shape(piece, rows):
        observer, observed = experiment.graph.edges.T
        there = np.isin(rows, some)
        links = np.stack([ends[there][:, observer], ends[there][:, observed]], axis=2)
        recorder.columns(f"{PREDICTION}/links", t[there], _strips(links))


def prediction_style(recorder: Recorder, experiment: Experiment) -> None:
    """A ring in its agent's colour where each is predicted to end, and the sensing graph between them."""
    n, m = experiment.n, len(experiment.graph.edges)
    shades = [style.tint(style.agent_colour(row), 0.7) for row in range(n)]
    rings = rr.LineStrips2D.from_fields(colors=shades, radii=[0.004] * n, draw_order=2.0)
    recorder.fixed(f"{PREDICTION}/rings", rings)
    links = rr.LineStrips2D.from_fields(colors=[style.GHOST] * m, radii=[0.002] * m, draw_order=1.0)
    recorder.fixed(f"{PREDICTION}/links", links)


def camera(recorder: Recorder, piece: Piece) -> None:
    """A frame that goes with the formation: its origin is the centroid of the projected points, y down."""
    rows = _finite(piece.trajectory.points)
    centre = np.zeros((len(rows), 3))
    centre[:, :2] = piece.trajectory.points[rows].mean(axis=1) * [1.0, -1.0]
    recorder.columns(CAMERA, piece.t[rows], rr.Transform3D.columns(translation=centre))


def near(experiment: Experiment, points: Real) -> Real:
    """Half the width and half the height, metres, of what that camera has in sight."""
    states = points.reshape(-1, experiment.n, 2)
    spread = [
        np.abs(each - each.mean(axis=1, keepdims=True)).max(axis=1)
        for each in (states[_finite(states)], predicted_ends(experiment, states[0]))
    ]
    half: Real = np.maximum(np.quantile(spread[0], MOSTLY, axis=0), spread[1].max(axis=0)) + 1.5 * style.MARGIN
    return half


def _finite(states: Real) -> Index:
    """Rows of states (T, n, k) that can be drawn: all but the last one of a run that diverged."""
    return np.flatnonzero(np.isfinite(states).all(axis=(1, 2)))


def _closed(corners: Real) -> Single:
    return np.concatenate([corners, corners[:1]])[None].astype(np.float32)


def _strips(strips: Real) -> rr.ComponentColumnList:
    """Columns of strips (T, k, p, 2): k strips of p points at each time."""
    times, count, points = strips.shape[:3]
    return rr.LineStrips2D.columns(strips=strips.reshape(-1, points, 2).astype(np.float32)).partition(
        np.full(times, count)
    )


def _multiples(side: tuple[float, float], step: float) -> Real:
    return step * np.arange(np.ceil(side[0] / step), np.floor(side[1] / step) + 1.0)


def _body(robot: RobotModel) -> tuple[Single, Single, Single]:
    """Strokes (k, 2, 2) that fill the chassis, its outline (1, 6, 2) with a nose, and the wheels (2, 2, 2), metres."""
    back, front = robot.chassis.outline[0, 0], robot.chassis.outline[1, 0]
    side = robot.chassis.width / 2.0
    strokes = np.linspace(-side + FILL, side - FILL, int(np.ceil(side / FILL)))
    fill = np.stack([np.stack([np.full_like(strokes, x), strokes], axis=-1) for x in (back + FILL, front - FILL)], 1)
    nose = [front + 0.3 * side, 0.0]
    corners = robot.chassis.outline
    outline = np.array([corners[0], corners[1], nose, corners[2], corners[3], corners[0]])[None]
    r, half = robot.drive.wheel_radius, robot.drive.base_length / 2.0
    wheels = np.array([[[-r, y], [r, y]] for y in (-half, half)])
    return fill.astype(np.float32), outline.astype(np.float32), wheels.astype(np.float32)


def _ticks(arena: Arena, x: Real, y: Real) -> rr.Points2D:
    """Coordinates along the lower and the left side, metres. The viewer writes a label a little below its point."""
    gap, (left, bottom) = style.TICK_SHARE * float(np.ptp(arena.corners, axis=0).max()), arena.corners[0]
    places = [[value, bottom] for value in x] + [[left - gap, value + 0.4 * gap] for value in y]
    labels = [f"{value:g}" for value in (*x, *y)]
    return rr.Points2D(places, labels=labels, show_labels=True, colors=style.TEXT, radii=1e-4, draw_order=-10.0)
