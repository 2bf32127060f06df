"""What happens on the way, in the viewer: a line of the log, a sign on the floor, obstacles that come and go."""

from __future__ import annotations

import numpy as np
import rerun as rr

from scenarios.definition.events.event import Event
from scenarios.recording.piece import Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import style
from scenarios.recording.views.obstacles import hatching
from scenarios.recording.views.scene import WORLD
from scenarios.recording.views.timeline import EVENTS
from scenarios.simulation.outages import whereabouts

SIGNS = f"{WORLD}/happenings"

SHORTEST = 3.0
"""Seconds for which a sign stands on the floor at least."""


def happenings(recorder: Recorder, piece: Piece) -> None:
    """The begin and the end of each event; nothing of a run without events."""
    for event in piece.experiment.events:
        begins, ends = _within(piece, event.begin), _within(piece, max(event.end, event.begin + SHORTEST))
        if begins:
            _log(recorder, event.begin, event.what, rr.TextLogLevel.WARN)
            _show(recorder, piece, event)
        if event.over and _within(piece, event.end):
            _log(recorder, event.end, event.over, rr.TextLogLevel.INFO)
        if ends:
            _hide(recorder, event, max(event.end, event.begin + SHORTEST))


def _within(piece: Piece, time: float) -> bool:
    """Whether a time is of this piece and of no other."""
    return bool(piece.t[0] <= time < piece.t[-1])


def _log(recorder: Recorder, time: float, text: str, level: rr.TextLogLevel) -> None:
    recorder.columns(f"{EVENTS}/happenings", np.array([time]), rr.TextLog.columns(text=[text], level=[str(level)]))


def _show(recorder: Recorder, piece: Piece, event: Event) -> None:
    entity, t = f"{SIGNS}/{event.number}", np.array([event.begin])
    place = whereabouts(event, piece.trajectory)
    if place is None:
        return
    colour = style.LIMIT if event.row is None else style.agent_colour(event.row)
    recorder.fixed(entity, rr.Points2D.from_fields(colors=[colour], radii=[0.02], draw_order=14.0, show_labels=True))
    recorder.columns(
        entity, t, rr.Points2D.columns(positions=np.array([place], dtype=np.float32), labels=[_sign(event)])
    )
    if event.obstacle is not None:
        outline = event.obstacle.outline.astype(np.float32)
        recorder.fixed(
            f"{entity}/outline", rr.LineStrips2D.from_fields(colors=[style.WALL], radii=[0.008], draw_order=-15.0)
        )
        strips = [outline, *hatching(outline)]
        recorder.columns(f"{entity}/outline", t, rr.LineStrips2D.columns(strips=strips).partition([len(strips)]))


def _hide(recorder: Recorder, event: Event, time: float) -> None:
    t: Real = np.array([time])
    nothing = rr.Points2D.columns(positions=np.empty((0, 2), dtype=np.float32), labels=[]).partition([0])
    recorder.columns(f"{SIGNS}/{event.number}", t, nothing)
    if event.obstacle is not None:
        none = rr.LineStrips2D.columns(strips=[]).partition([0])
        recorder.columns(f"{SIGNS}/{event.number}/outline", t, none)


def _sign(event: Event) -> str:
    return f"{event.number}: {event.kind}"
