"""Where streams put their columns: one rerun recording, seen from one entity."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios.recording.views import style
from scenarios.recording.views.style import Colour

Real = NDArray[np.float64]

APPLICATION = "angle-formation"
TIMELINE = "sim_time"
"""Simulation time, so that 1x in the viewer is real time."""


class Recorder:
    """A recording and the entity below which a run goes.

    Args:
        recording: the rerun stream.
        root: entity path of the run, without slashes at its ends; empty for a recording of one run.
        colour: of the curves that belong to the whole formation.
    """

    def __init__(self, recording: rr.RecordingStream, root: str = "", colour: Colour = style.MEASURED) -> None:
        self._recording = recording
        self.root = root
        self.colour = colour

    def path(self, entity: str) -> str:
        """The full path of an entity of the run."""
        return f"/{self.root}/{entity}" if self.root else f"/{entity}"

    def fixed(self, entity: str, *content: rr.AsComponents) -> None:
        """Log what holds at all times."""
        self._recording.log(self.path(entity), *content, static=True)

    def columns(self, entity: str, t: Real, *content: Iterable[rr.ComponentColumn]) -> None:
        """Log one row at each of the times t (T,), seconds; nothing where T is 0."""
        if len(t):
            index = rr.TimeColumn(TIMELINE, duration=nanoseconds(t))
            self._recording.send_columns(
                self.path(entity), indexes=[index], columns=[column for part in content for column in part]
            )

    def parameters(self, name: str, values: rr.AnyValues) -> None:
        """Log properties of the recording."""
        self._recording.send_property(name, values)


def open_stream(recording_id: str) -> rr.RecordingStream:
    """A stream whose chunks depend on what is logged alone: no wall-clock time, no machine, no random identity."""
    stream = rr.RecordingStream(
        APPLICATION,
        recording_id=recording_id,
        send_properties=False,
        batcher_config=rr.ChunkBatcherConfig.NEVER(),  # batches by the clock differ from run to run
    )
    stream.set_log_time_enabled(False)
    stream.set_log_tick_enabled(False)
    return stream


def nanoseconds(t: Real) -> NDArray[np.timedelta64]:
    """Times (T,) in seconds as the viewer takes them without loss: floats would be cut to its own unit."""
    return np.round(t * 1e9).astype("timedelta64[ns]")
