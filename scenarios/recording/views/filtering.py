"""The safety filter in the arena: the circles that it keeps apart, and each velocity before and after it."""

from __future__ import annotations

import numpy as np
import rerun as rr

from robots.testbed import COLLISION_DISTANCE
from scenarios.definition.experiment import Experiment
from scenarios.recording.piece import Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import scene, style

AHEAD = 0.8
"""Seconds of motion that an arrow stands for."""

LONGEST = 0.24
"""Metres from which an arrow is cut: the law may ask for more than any robot can do."""


def circles(recorder: Recorder, experiment: Experiment) -> None:
    """About each projected point: half the distance that is kept, and with a filter the range in which it senses.

    Two circles of the first kind touch where the filter, or without one the testbed, says no.
    """
    settings, filtered = experiment.filter_settings, experiment.safety != "none"
    kept = settings.safe_distance if filtered else COLLISION_DISTANCE
    for row, point in enumerate(scene.points_ahead(experiment)):
        robot = f"{scene.ROBOTS}/{experiment.number(row)}"
        _circle(recorder, f"{robot}/kept", point, kept / 2.0, style.tint(style.LIMIT, 0.5))
        if filtered and experiment.n <= style.CROWD:
            _circle(recorder, f"{robot}/sensing", point, settings.sensing_range, style.RANGE)


def velocities(recorder: Recorder, piece: Piece) -> None:
    """What each robot does, and under it, in gold, what the law asked for before the filter; none in a crowd."""
    experiment, rows = piece.experiment, piece.frames()
    wish, command = (each[rows] for each in (piece.trajectory.wish, piece.trajectory.command))
    rows = rows[known := np.isfinite(wish).all(axis=(1, 2)) & np.isfinite(command).all(axis=(1, 2))]
    if experiment.n > style.CROWD or not len(rows):
        return
    arrows = np.stack([_cut(wish[known]), _cut(command[known])], axis=2)
    two = np.full(len(rows), 2)
    for row in range(experiment.n):
        vectors = arrows[:, row].reshape(-1, 2).astype(np.float32)
        entity = f"{scene.ROBOTS}/{experiment.number(row)}/velocity"
        recorder.columns(entity, piece.t[rows], rr.Arrows2D.columns(vectors=vectors).partition(two))


def velocities_style(recorder: Recorder, experiment: Experiment) -> None:
    """From the projected point, in the robot's own frame; gold under white."""
    if experiment.n > style.CROWD:
        return
    for row, point in enumerate(scene.points_ahead(experiment)):
        arrows = rr.Arrows2D.from_fields(
            origins=[[point, 0.0]] * 2, colors=[style.SECOND, style.TEXT], radii=[0.008, 0.004], draw_order=13.0
        )
        recorder.fixed(f"{scene.ROBOTS}/{experiment.number(row)}/velocity", arrows)


def _circle(recorder: Recorder, entity: str, point: float, radius: float, colour: style.Colour) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    ring = radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1) + [point, 0.0]
    strip = ring[None].astype(np.float32)
    recorder.fixed(entity, rr.LineStrips2D(strip, colors=colour, radii=0.002, draw_order=4.0))


def _cut(velocity: Real) -> Real:
    """Arrows (..., 2), metres, of velocities (..., 2), m/s, none longer than :data:`LONGEST`."""
    arrow = AHEAD * velocity
    length = np.linalg.norm(arrow, axis=-1, keepdims=True)
    return arrow * np.minimum(1.0, LONGEST / np.maximum(length, LONGEST))
