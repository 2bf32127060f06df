"""The angles that the law is about, drawn at their vertices: what they are now, what they lack, both in words."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.recording.piece import Index, Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import scene, style

ANGLES = f"{scene.WORLD}/angles"
MEASURED, ERROR = f"{ANGLES}/measured", f"{ANGLES}/error"

WORDS = f"{ANGLES}/words"
"""For views that are near enough to read them."""

INNER, STEP = 0.11, 0.025
"""Metres: the radius of a vertex's first arc, and how much farther out each further one lies."""

BEYOND = 0.07
"""Metres from an arc to the middle of its words."""

ALONG = (0.5, 0.25, 0.75)
"""Where along an arc its words may stand, in the order in which the places are tried."""

PANEL, WORDS_SIZE, LETTER = np.array([800.0, 440.0]), np.array([90.0, 30.0]), 7.5
"""Points of the screen: the view in a window that is not large, an angle in words, and a letter of a robot's label."""

POINTS, ERROR_POINTS = 14, 5
"""Points of an arc, and of the part that is missing or too much."""


def arcs(recorder: Recorder, piece: Piece) -> None:
    """An arc from the first ray to the second, and on from there to where the second ray should be.

    In words: the angle and, in brackets, its error, degrees; those that have room. None of them in a crowd, which they
    would hide. They go with the centroid, so that a formation that only moves is drawn once.
    """
    experiment = piece.experiment
    if experiment.n > style.CROWD:
        return
    points = piece.trajectory.points
    whole = np.flatnonzero(np.isfinite(points).all(axis=(1, 2)))
    centre = points.mean(axis=1)
    place = np.concatenate([centre[whole], np.zeros((len(whole), 1))], axis=1)
    recorder.columns(ANGLES, piece.t[whole], rr.Transform3D.columns(translation=place))
    rows = piece.frames()
    rows = rows[np.isfinite(experiment.angles.measure(points[rows])).all(axis=1)]
    measured, errors = experiment.angles.measure(points[rows]), piece.angle_errors[rows]
    points = points[rows] - centre[rows, None]
    vertex, first, _ = experiment.angles.triples.T
    ray = points[:, first] - points[:, vertex]
    start = np.arctan2(ray[..., 1], ray[..., 0])
    end, radius = start + measured, INNER + STEP * _rank(vertex)
    t, m = piece.t[rows], np.full(len(rows), len(vertex))
    for entity, ends, count in ((MEASURED, (start, end), POINTS), (ERROR, (end, end - errors), ERROR_POINTS)):
        strips = points[:, vertex, None] + _arc(*ends, radius, count)
        columns = rr.LineStrips2D.columns(strips=strips.reshape(-1, count, 2).astype(np.float32))
        recorder.columns(entity, t, columns.partition(m))
    ways = [start + share * measured for share in ALONG]
    far = (radius + BEYOND)[:, None]
    places = np.stack([points[:, vertex] + far * np.stack([np.cos(way), np.sin(way)], axis=-1) for way in ways])
    places, shown = apart(places, points, _sizes(experiment, scene.near(experiment, piece.trajectory.points)))
    words = [f"{value:.0f}° ({error:+z.1f})" for value, error in np.degrees([measured[shown], errors[shown]]).T]
    colours = np.array([style.pale(style.agent_colour(row)) for row in vertex], dtype=np.uint8)[np.nonzero(shown)[1]]
    columns = rr.Points2D.columns(positions=places[shown], labels=words, colors=colours)
    recorder.columns(WORDS, t, columns.partition(shown.sum(axis=1)))


def arcs_style(recorder: Recorder, experiment: Experiment) -> None:
    """In the colour of the agent at the vertex; what is missing in red."""
    if experiment.n > style.CROWD:
        return
    vertices = experiment.angles.triples[:, 0]
    m = len(vertices)
    shades = [style.agent_colour(row) for row in vertices]
    arcs = rr.LineStrips2D.from_fields(colors=shades, radii=[0.003] * m, draw_order=6.0)
    recorder.fixed(MEASURED, arcs)
    missing = rr.LineStrips2D.from_fields(colors=[style.LIMIT] * m, radii=[0.006] * m, draw_order=7.0)
    recorder.fixed(ERROR, missing)
    words = rr.Points2D.from_fields(radii=[1e-4] * m, show_labels=True, draw_order=14.0)
    recorder.fixed(WORDS, words)


def _arc(start: Real, end: Real, radius: Real, count: int) -> Real:
    """(T, m, count, 2) points on circles of the radii (m,), metres, between directions (T, m), radians."""
    turn = start[..., None] + (end - start)[..., None] * np.linspace(0.0, 1.0, count)
    return radius[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def _rank(vertex: Index) -> Real:
    """(m,) how many angles before each one have the same vertex."""
    return np.array([np.count_nonzero(vertex[:row] == vertex[row]) for row in range(len(vertex))], dtype=np.float64)


def _sizes(experiment: Experiment, half: Real) -> Real:
    """(1 + n, 2) width and height, metres, of an angle in words and of each robot's label, with ``half`` in sight."""
    letters = [len(label) + 1 for label in scene.labels(experiment)]
    sizes = np.vstack([WORDS_SIZE, [(LETTER * count, WORDS_SIZE[1]) for count in letters]])
    return sizes / (PANEL / (2.0 * half)).min()


def apart(places: Real, points: Real, sizes: Real) -> tuple[Real, NDArray[np.bool_]]:
    """Where (T, m, 2) words stand, and which (T, m) of them may: over no other words and no robot's label.

    Args:
        places: (k, T, m, 2) for each the places that it may have, metres, the best one first.
        points: (T, n, 2) of the robots.
        sizes: (1 + n, 2) of words and of labels.
    """
    chosen, shown = places[0].copy(), np.zeros(places.shape[1:3], dtype=np.bool_)
    for row in range(places.shape[2]):
        for place in places[:, :, row]:
            words = (np.abs(chosen[:, :row] - place[:, None]) < sizes[0]).all(axis=-1) & shown[:, :row]
            labels = (np.abs(points - place[:, None]) < (sizes[0] + sizes[1:]) / 2.0).all(axis=-1)
            free = ~(shown[:, row] | words.any(axis=1) | labels.any(axis=1))
            chosen[free, row] = place[free]
            shown[:, row] |= free
    return chosen, shown
