"""Why a run of a sweep missed its goal: one word for each, from how it began and how it ended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.testbed import separation
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import predicted_ends
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

ERROR, DIVERGED, TIGHT, STUCK, MOVING, RESTING = "error", "diverged", "tight_end", "stuck", "moving", "resting"

MEANINGS = {
    ERROR: "could not be made",
    DIVERGED: "ended in no number",
    "floor": "converged, but left the floor",
    "collision": "converged, but came too close to each other",
    "obstacle": "converged, but came too close to an obstacle",
    TIGHT: "had to end closer to each other than the filter allows",
    STUCK: "ended in a deadlock",
    MOVING: "were still on their way",
    RESTING: "came to rest elsewhere",
}
"""What runs of each cause did."""

STILL = 1e-5
"""m/s; slower robots count as standing: in a minute they get no further than a hair."""


class Ends(NamedTuple):
    """A run's first and last moment.

    Attributes:
        start: (n, 2) projected points, metres.
        stuck: (n,) for how long each robot has made no progress, by the filter, seconds.
        command: (n, 2) the last commands, m/s.
    """

    start: Real
    stuck: Real
    command: Real

    @classmethod
    def of(cls, trajectory: Trajectory) -> Ends:
        return cls(trajectory.points[0], trajectory.stuck[-1], trajectory.command[-1])


def cause_of(experiment: Experiment, outcome: str, violations: Sequence[str], ends: Ends) -> str:
    """The cause of a run's outcome, a key of :data:`MEANINGS`; empty where it converged."""
    if outcome == "converged":
        return ""
    if outcome == "diverged":
        return DIVERGED
    if outcome == "rejected":
        return next(kind for kind in violations if kind in MEANINGS)
    if _tight(experiment, ends.start):
        return TIGHT
    if (ends.stuck >= experiment.filter_settings.stuck_time).any():
        return STUCK
    return MOVING if np.hypot(*ends.command.T).max() > STILL else RESTING


def _tight(experiment: Experiment, start: Real) -> bool:
    """Whether two places of a predicted end are nearer to each other than the filter lets robots be."""
    if experiment.safety not in ("decentralised", "centralised") or not experiment.predicted:
        return False
    return bool(
        (separation(predicted_ends(experiment, start)).distance < experiment.filter_settings.safe_distance).any()
    )
