"""What a run leaves behind: the recorded states."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.errors import InputError

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
    """

    t: Real
    poses: Real
    points: Real
    wheel_speeds: Real
    phase: NDArray[np.intp]

    def run(self, index: int) -> Trajectory:
        """One run of a batch with one batch dimension."""
        return Trajectory(self.t, self.poses[:, index], self.points[:, index], self.wheel_speeds[:, index], self.phase)

    def save(self, path: Path, angle_errors: Real) -> None:
        """Write ``trajectory.npz``, with the angle errors (T, m), radians, beside the states."""
        np.savez_compressed(
            path,
            t=self.t,
            poses=self.poses,
            points=self.points,
            wheel_speeds=self.wheel_speeds,
            phase=self.phase,
            angle_errors=angle_errors,
        )

    @classmethod
    def read(cls, path: Path) -> Trajectory:
        """Read ``trajectory.npz``.

        Raises:
            InputError: the file is missing or damaged.
        """
        try:
            with np.load(path) as data:
                return cls(data["t"], data["poses"], data["points"], data["wheel_speeds"], data["phase"])
        except Exception as error:  # numpy and zipfile raise many kinds for damaged files
            raise InputError(f"{path}: cannot be read: {error}") from error
