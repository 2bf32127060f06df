"""Runs as the content of a recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import Metrics, measure
from scenarios.recording.piece import whole
from scenarios.recording.recorder import Recorder, open_stream
from scenarios.recording.streams import send_motion, send_outcome, send_setup
from scenarios.recording.views import blueprint, style
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.run_folder import Run


class Side(NamedTuple):
    """One of two runs: the entity below which it goes, and the colour of its curves with its name."""

    root: str
    colour: style.Colour
    word: str


SIDES = (Side("A", style.MEASURED, "blue"), Side("B", style.SECOND, "gold"))


@np.errstate(over="ignore", invalid="ignore")  # a diverged run has a recording too
def encode(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, result: dict[str, Any]) -> bytes:
    """The recording of one run, as the content of an ``.rrd`` file."""
    seed = result["seed"]
    layout = blueprint.single(experiment, trajectory.points)
    with _in_memory(identity(experiment, seed), title(experiment, seed), layout) as (stream, memory):
        _send(Recorder(stream), experiment, trajectory, metrics, result)
        return memory.drain_as_bytes()


def encode_run(run: Run) -> bytes:
    """The recording of a run that was read back, as the content of an ``.rrd`` file."""
    metrics = measure(run.experiment, run.trajectory)
    return encode(run.experiment, run.trajectory, metrics, run.result)


@np.errstate(over="ignore", invalid="ignore")  # a diverged run has a recording too
def encode_pair(runs: Sequence[Run]) -> bytes:
    """One recording of two runs, side by side and in shared axes."""
    names = [title(run.experiment, run.result["seed"]) for run in runs]
    layout = blueprint.pair(
        [run.experiment for run in runs],
        [run.trajectory.points for run in runs],
        [side.root for side in SIDES],
        [f"{side.root}, {side.word}: {name}" for side, name in zip(SIDES, names, strict=True)],
    )
    ids = [identity(run.experiment, run.result["seed"]) for run in runs]
    with _in_memory(" ".join(ids), " beside ".join(names), layout) as (stream, memory):
        for side, run in zip(SIDES, runs, strict=True):
            metrics = measure(run.experiment, run.trajectory)
            _send(Recorder(stream, side.root, side.colour), run.experiment, run.trajectory, metrics, run.result)
        return memory.drain_as_bytes()


def identity(experiment: Experiment, seed: int) -> str:
    """What two recordings share only if they are of the same run."""
    return f"{experiment.file.name}-{experiment.plant}-seed{seed}-{experiment.file.sha256[:12]}"


def title(experiment: Experiment, seed: int) -> str:
    """How people tell runs apart."""
    return f"{experiment.file.name}, {experiment.plant}, safety {experiment.safety}, seed {seed}"


@contextmanager
def _in_memory(
    recording_id: str, name: str, layout: rrb.Blueprint
) -> Iterator[tuple[rr.RecordingStream, rr.MemoryRecording]]:
    """A stream into memory: only our own writing tells of a full disk."""
    stream = open_stream(recording_id)
    memory = stream.memory_recording()
    stream.send_recording_name(name)
    stream.send_blueprint(layout)
    try:
        yield stream, memory
    finally:
        stream.disconnect()


def _send(
    recorder: Recorder, experiment: Experiment, trajectory: Trajectory, metrics: Metrics, result: dict[str, Any]
) -> None:
    send_setup(recorder, experiment)
    send_motion(recorder, whole(experiment, trajectory, metrics))
    send_outcome(recorder, experiment, result)
