"""A log of one robot on the testbed: what the cameras saw and what the encoders had counted, loop turn by loop turn.

The testbed's loop waits for at least so long in every turn and stamps nothing, so a log's only clock is its turns: lags
and jitter are fractions of a turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

SLOWEST = 3.0
"""Counts per turn below which a wheel may stand for a whole turn, so that a lost message does not show."""


class LogError(ValueError):
    """A log that cannot be used; the message is one line with what was found and what was expected."""


@dataclass(frozen=True, eq=False)
class Log:
    """T turns of one robot.

    Attributes:
        poses: (T, 3) x, y, theta of the tracked point, metres and radians, theta continuous; NaN rows where the
            cameras gave nothing.
        counts: (T, 2) left and right encoder counts, continuous; NaN rows where the encoders gave nothing.
        heading_quantum: step to which the headings are rounded, radians; 0 where none shows.
        repairs: what was repaired, a sentence each.
    """

    poses: Real
    counts: Real
    heading_quantum: float = 0.0
    repairs: tuple[str, ...] = ()

    @property
    def turns(self) -> int:
        return len(self.poses)

    @cached_property
    def seen(self) -> Flags:
        """(T,) whether the cameras gave a new pose."""
        return _new(self.poses)

    @cached_property
    def heard(self) -> Flags:
        """(T,) whether the encoders gave new counts. Of a robot at rest nobody can tell, and it does not matter."""
        return _new(self.counts)

    @cached_property
    def moving(self) -> Flags:
        """(T,) whether a wheel was moving, so that counts that are not new are a lost message."""
        turns = np.arange(self.turns)
        known = np.flatnonzero(self.heard)
        spread = np.stack([np.interp(turns, known, self.counts[known, side]) for side in (0, 1)], axis=-1)
        moving = np.asarray(np.abs(np.gradient(spread, axis=0)).max(axis=1) > SLOWEST)
        moving[0] = False
        moving[known[-1] + 1 :] = False
        return moving


def _new(values: Real) -> Flags:
    """(T,) rows that hold a value and not that of the row before."""
    new = np.isfinite(values[:, 0])
    rows = np.flatnonzero(new)
    new[rows[1:]] = (np.diff(values[rows], axis=0) != 0.0).any(axis=1)
    return new
