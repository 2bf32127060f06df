"""A script that a viewer watches while it runs. The run folder gets the whole recording, with or without a viewer."""

from __future__ import annotations

import uuid
from dataclasses import fields
from time import monotonic, sleep

import rerun as rr

from robots.model import CONTROL_PERIOD
from robots.rps.robotarium import Robotarium
from robots.rps.simulation import Record
from scenarios.recording.live import FLUSH, FRAME
from scenarios.recording.recorder import Recorder, open_stream
from scenarios.recording.script import layout, send_motion, send_setup
from scenarios.simulation.script.script_file import ScriptFile


class ScriptView:
    """Sends what a script's robots do to a viewer, no faster than they would do it.

    Args:
        file: the script.
        plant, seed: of the run.
        sink: where the stream goes.
    """

    def __init__(self, file: ScriptFile, plant: str, seed: int, sink: rr.GrpcSink | rr.FileSink) -> None:
        self._stream = open_stream(f"{file.name}-{plant}-seed{seed}-{uuid.uuid4()}")
        self._stream.set_sinks(sink)
        self._stream.send_recording_name(f"{file.name}, {plant}, seed {seed}")
        self._recorder = Recorder(self._stream)
        self._sent, self._sent_at, self._begin = 0, 0.0, 0.0

    def begin(self, robots: Robotarium) -> None:
        """Show these robots, in the place of those before them."""
        self._sent, self._sent_at, self._begin = 0, 0.0, monotonic()
        self._stream.send_blueprint(layout(robots.record().poses, figure=False, live=True))
        send_setup(self._recorder, robots.number_of_robots)

    def look(self, robots: Robotarium) -> None:
        """Take the newest state."""
        ahead = robots.steps * CONTROL_PERIOD - (monotonic() - self._begin)
        if ahead > 0.0:
            sleep(ahead)
        if monotonic() - self._sent_at >= FRAME:
            record = robots.record()
            send_motion(self._recorder, Record(*(getattr(record, each.name)[self._sent :] for each in fields(record))))
            self._stream.flush(timeout_sec=0.0)
            self._sent, self._sent_at = robots.steps, monotonic()

    def finish(self) -> bool:
        """Let go of the viewer. Returns whether all has left in time."""
        try:
            self._stream.flush(timeout_sec=FLUSH)
        except RuntimeError:
            return False
        finally:
            self._stream.disconnect()
        return True
