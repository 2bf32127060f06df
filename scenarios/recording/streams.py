"""All streams of a recording. A new one is a function and a line here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenarios.definition.experiment import Experiment
from scenarios.recording.piece import Piece
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import angles, filtering, happenings, legend, obstacles, plots, scene, summary, timeline

SETUP: tuple[Callable[[Recorder, Experiment], None], ...] = (
    scene.floor,
    obstacles.outlines,
    scene.bodies,
    scene.sensing_style,
    scene.trails_style,
    scene.prediction_style,
    filtering.circles,
    filtering.velocities_style,
    angles.arcs_style,
    legend.page,
    plots.styles,
    timeline.styles,
)
"""What is known before anything moves."""

MOTION: tuple[Callable[[Recorder, Piece], None], ...] = (
    scene.poses,
    scene.sensing,
    scene.trails,
    scene.prediction,
    scene.camera,
    filtering.velocities,
    angles.arcs,
    plots.angle_errors,
    plots.error_sum,
    plots.wheel_speeds,
    plots.separation,
    plots.clearance,
    plots.interventions,
    plots.tracking,
    timeline.phases,
    happenings.happenings,
    timeline.activation,
    timeline.goal,
    timeline.safety,
    timeline.separation,
    timeline.contacts,
    timeline.floor,
)
"""What is known of each control period."""

OUTCOME: tuple[Callable[[Recorder, Experiment, dict[str, Any]], None], ...] = (summary.page, summary.parameters)
"""What is known at the end."""


def send_setup(recorder: Recorder, experiment: Experiment) -> None:
    """Send what is known before the run."""
    for stream in SETUP:
        stream(recorder, experiment)


def send_motion(recorder: Recorder, piece: Piece) -> None:
    """Send what is known of a piece of the run."""
    for stream in MOTION:
        stream(recorder, piece)


def send_outcome(recorder: Recorder, experiment: Experiment, result: dict[str, Any]) -> None:
    """Send what is known after the run."""
    for stream in OUTCOME:
        stream(recorder, experiment, result)
