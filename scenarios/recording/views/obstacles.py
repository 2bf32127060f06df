"""What stands on the floor, hatched so that nobody takes it for a mark."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import style
from scenarios.recording.views.scene import WORLD

OBSTACLES = f"{WORLD}/obstacles"

HATCH_STEP = 0.025
"""Metres between two strokes of an obstacle's hatching."""


def outlines(recorder: Recorder, experiment: Experiment) -> None:
    """What stands on the floor, outlined and hatched."""
    closed = [obstacle.outline.astype(np.float32) for obstacle in experiment.arena.obstacles]
    if not closed:
        return
    recorder.fixed(OBSTACLES, rr.LineStrips2D(closed, colors=style.WALL, radii=0.005, draw_order=-15.0))
    strokes = np.concatenate([hatching(outline) for outline in closed])
    recorder.fixed(f"{OBSTACLES}/hatching", rr.LineStrips2D(strokes, colors=style.HATCH, radii=0.003, draw_order=-16.0))


def hatching(outline: NDArray[np.float32]) -> NDArray[np.float32]:
    """(k, 2, 2) strokes at 45 degrees inside a convex, closed outline (m, 2), metres."""
    if len(outline) < 4:  # a segment without a radius has no inside
        return np.empty((0, 2, 2), dtype=np.float32)
    across = outline @ np.array([1.0, -1.0]) / np.sqrt(2.0)
    low, high = across.min(), across.max()
    count = max(1, int((high - low) / HATCH_STEP))
    strokes = []
    for level in low + (high - low) * (np.arange(count) + 0.5) / count:
        below = across <= level
        sides = np.flatnonzero(below[1:] != below[:-1])
        share = (level - across[sides]) / (across[sides + 1] - across[sides])
        strokes.append(outline[sides] + share[:, None] * (outline[sides + 1] - outline[sides]))
    return np.array(strokes, dtype=np.float32)
