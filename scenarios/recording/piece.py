"""What streams are given: a piece of a run, from a single control period to the whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots.testbed import Separation, separation
from scenarios.definition.experiment import Experiment
from scenarios.measures.clearance import Clearance, clearance
from scenarios.measures.metrics import Metrics, checked
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Index = NDArray[np.intp]


FRAME = 0.2
"""Seconds between two pictures of what is drawn less often than measured."""

STILL = 1e-4
"""Metres in a control period up to which an agent stands still in its formation to the eye."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Consecutive control periods of a run, with what is measured of each.

    Pieces that follow each other overlap by one row, so that each of them sees what changed.

    Attributes:
        experiment: what is run.
        start: (n, 2) initial projected points of the run, metres.
        trajectory: the states (T, ...) of the piece.
        angle_errors: (T, m) radians.
        error_sum: (T,) their absolute sum.
        separation: of the collision centres.
        clearance: from walls and obstacles; None on a floor with neither.
    """

    experiment: Experiment
    start: Real
    trajectory: Trajectory
    angle_errors: Real
    error_sum: Real
    separation: Separation
    clearance: Clearance | None

    @property
    def t(self) -> Real:
        """(T,) seconds."""
        return self.trajectory.t

    def changes(self, values: NDArray[Any]) -> Index:
        """Rows whose value differs from the row before, and the run's first row, of values (T, ...)."""
        differs = values[1:] != values[:-1]
        rows = np.flatnonzero(differs.reshape(len(differs), -1).any(axis=1)) + 1
        return np.concatenate([[0], rows]).astype(np.intp) if self.t[0] == 0.0 else rows

    def frames(self) -> Index:
        """Rows for what is drawn less often than measured: five a second while the formation changes, else one."""
        rows = self.changes(np.floor(self.t / FRAME + 1e-9))
        within = self.trajectory.points - self.trajectory.points.mean(axis=1, keepdims=True)
        moved = np.abs(np.diff(within, axis=0, prepend=within[:1]))
        moves = moved.max(axis=(1, 2)) > STILL
        second = np.isin(rows, self.changes(np.floor(self.t + 1e-9)))
        return rows[moves[rows] | second]


def whole(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> Piece:
    """The whole of a measured run."""
    return Piece(
        experiment,
        trajectory.points[0],
        trajectory,
        metrics.angle_errors,
        metrics.error_sum,
        metrics.separation,
        metrics.clearance,
    )


def rows(experiment: Experiment, trajectory: Trajectory, first: int, end: int) -> Piece:
    """The rows from ``first`` up to, not including, ``end`` of a run that goes on."""
    part = trajectory.between(first, end)
    errors = experiment.angles.errors(part.points, experiment.targets(part.phase))
    return Piece(
        experiment,
        trajectory.points[0],
        part,
        errors,
        np.abs(errors).sum(axis=-1),
        separation(checked(experiment, part)),
        clearance(experiment, part),
    )
