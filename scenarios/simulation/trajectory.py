"""What a run leaves behind: the recorded states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The states of a run at the end of every control period; row 0 is the start.

    A batch of runs has its dimensions between T and n.

    Attributes:
        t: (T,) seconds.
        poses: (T, ..., n, 3) x, y, theta of the axle centres, metres and radians, theta not wrapped.
        points: (T, ..., n, 2) projected points, metres.
        wheel_speeds: (T, ..., n, 2) left and right wheel speeds during the period that ends at t, rad/s; NaN for a
            plant without wheels.
        phase: (T,) index of the phase that the period belongs to.
        contact: (T, ..., n) what each agent touched during the period; see :class:`robots.worlds.World`.
        active: (T, ..., n) which agents follow the law; all but those that wait in sequential activation.
        intervention: (T, ..., n) how far the safety filter moved the law's velocity during the period, m/s.
        relaxation: (T, ..., n) by how much the rows of an infeasible problem were lowered, m/s.
        blockers: (T, ..., n, 3) whose rows those were; see :class:`robots.safety.SafetyFilter`.
        stuck: (T, ..., n) for how long an agent has made no progress, seconds.
        wish: (T, ..., n, 2) what the law and v_r ask for during the period that ends at t, in each robot's own frame at
            its beginning, m/s; 0 in row 0.
        command: (T, ..., n, 2) the same after the safety filter, before the wheels' limits.
    """

    t: Real
    poses: Real
    points: Real
    wheel_speeds: Real
    phase: NDArray[np.intp]
    contact: NDArray[np.intp]
    active: NDArray[np.bool_]
    intervention: Real
    relaxation: Real
    blockers: NDArray[np.int32]
    stuck: Real
    wish: Real
    command: Real

    def run(self, index: int) -> Trajectory:
        """One run of a batch with one batch dimension."""
        whole = ("t", "phase")
        states = {field.name: getattr(self, field.name) for field in fields(self)}
        return Trajectory(*(a if name in whole else a[:, index] for name, a in states.items()))

    def until(self, rows: int) -> Trajectory:
        """The first ``rows`` rows."""
        return self.between(0, rows)

    def between(self, first: int, end: int) -> Trajectory:
        """The rows from ``first`` up to, not including, ``end``."""
        return Trajectory(*(getattr(self, field.name)[first:end] for field in fields(self)))

    def save(self, path: Path, angle_errors: Real) -> None:
        """Write ``trajectory.npz``, with the angle errors (T, m), radians, beside the states.

        :mod:`scenarios.storage.states` reads it back.
        """
        states = {field.name: getattr(self, field.name) for field in fields(self)}
        np.savez_compressed(path, angle_errors=angle_errors, **states)


OnPeriod = Callable[[int, int], None]
"""Called after a control period with the number of periods done and of all."""

OnState = Callable[[Trajectory, int], None]
"""Called after a control period with the trajectory, which has room for all, and the row of the newest state."""
