"""What every safety filter offers, and what it says about itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from robots.obstacles import Obstacle
from robots.senses.noise import Noise as Noise

Real = NDArray[np.float64]

WALLS = 4
"""Sides of the arena; rows of a filter's problem number them after the robots, and obstacles after them."""

BLOCKERS = 3
"""At a vertex of the least relaxation at most three rows meet."""


class SafetyFilter(Protocol):
    """A filter between the law and the wheels.

    Attributes describe the last period:
        intervention: (..., n) m/s, distance of the filtered velocity from the law's within the wheels' limits.
        relaxation: (..., n) m/s, least amount by which the rows of a robot whose problem was infeasible had to be
            lowered; 0 where it was feasible.
        blockers: (..., n, 3) what those rows belong to: robots 0..n-1, walls n..n+3 (south, east, north, west), then
            obstacles; -1 where there is none.
        stuck: (..., n) seconds for which a robot has made no progress.
    """

    intervention: Real
    relaxation: Real
    blockers: NDArray[np.int32]
    stuck: Real

    def filter(
        self, points: Real, headings: Real, feedback: Real, common: Real, period: float, noise: Noise | None = None
    ) -> Real:
        """Body-frame velocities (..., n, 2), m/s, that keep the robots apart for one period.

        Args:
            points: (..., n, 2) projected points, metres. A filter that is distributed uses their differences within the
                sensing range alone.
            headings: (..., n, 2) unit vectors.
            feedback: (..., n, 2) the law without the common velocity, in body frames, m/s.
            common: (..., n, 2) the common velocity v_r, in body frames, m/s.
            period: seconds.
            noise: of the measurements; None for perfect sensors.
        """
        ...

    def avoid(self, obstacles: Sequence[Obstacle]) -> None:
        """Take these obstacles, as many as before, in the place of the arena's; for filters that know of obstacles."""
        ...


@runtime_checkable
class Distributed(SafetyFilter, Protocol):
    """A filter in which every robot answers for itself, from what it senses."""

    distributed: bool

    def filter(
        self,
        points: Real,
        headings: Real,
        feedback: Real,
        common: Real,
        period: float,
        noise: Noise | None = None,
        seen: Real | None = None,
    ) -> Real:
        """As above; ``seen`` (..., n, 2) is where each robot was when the others sensed it, metres."""
        ...
