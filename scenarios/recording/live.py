"""A run that a viewer watches while it is made.

What goes to the viewer is a copy: the run folder gets the whole recording in the end, with or without a viewer.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from typing import Any

import rerun as rr

from scenarios.definition.experiment import Experiment
from scenarios.recording.encode import identity, title
from scenarios.recording.piece import rows
from scenarios.recording.recorder import Recorder, open_stream
from scenarios.recording.streams import send_motion, send_outcome, send_setup
from scenarios.recording.viewer import LOOPBACK
from scenarios.recording.views import blueprint
from scenarios.simulation.trajectory import Trajectory

FRAME = 1.0 / 20.0
"""Seconds of wall-clock time between two messages to the viewer."""

FLUSH = 2.0
"""Seconds that a viewer has to take what is under way before the run goes on without it."""


def viewer_at(port: int) -> rr.GrpcSink:
    """The viewer that listens at ``port`` on this machine."""
    return rr.GrpcSink(f"rerun+http://{LOOPBACK}:{port}/proxy")


class LiveView:
    """Sends a run to a viewer as it goes, no faster than ``speed`` times real time.

    Args:
        experiment: what is run.
        seed: of the run.
        sink: where the stream goes.
        speed: simulated seconds per second.
        clock, sleep: of the wall.
    """

    def __init__(
        self,
        experiment: Experiment,
        seed: int,
        sink: rr.GrpcSink | rr.FileSink,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._experiment = experiment
        self._speed, self._clock, self._sleep = speed, clock, sleep
        # A viewer that saw this run before must not mix the two.
        self._stream = open_stream(f"{identity(experiment, seed)}-{uuid.uuid4()}")
        self._stream.set_sinks(sink)
        self._stream.send_recording_name(title(experiment, seed))
        self._recorder = Recorder(self._stream)
        self._begin: float | None = None
        self._sent_at = -FRAME
        self._sent = 0

    def __call__(self, trajectory: Trajectory, row: int) -> None:
        """Take the newest state; see :func:`scenarios.simulation.loop.simulate`."""
        if self._begin is None:
            self._begin = self._clock()
            self._stream.send_blueprint(blueprint.single(self._experiment, trajectory.points[:1], live=True))
            send_setup(self._recorder, self._experiment)
        ahead = trajectory.t[row] / self._speed - (self._clock() - self._begin)
        if ahead > 0.0:
            self._sleep(ahead)
        last = row + 1 == len(trajectory.t)
        if last or self._clock() - self._sent_at >= FRAME:
            send_motion(self._recorder, rows(self._experiment, trajectory, self._sent, row + 1))
            self._stream.flush(timeout_sec=0.0)
            self._sent, self._sent_at = row, self._clock()

    def finish(self, result: dict[str, Any]) -> bool:
        """Send the outcome and let go of the viewer. Returns whether all has left in time."""
        send_outcome(self._recorder, self._experiment, result)
        try:
            self._stream.flush(timeout_sec=FLUSH)
        except RuntimeError:
            return False
        finally:
            self._stream.disconnect()
        return True
