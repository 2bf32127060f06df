"""The arena: the floor that the testbed grants, with or without walls around it, and what stands on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.obstacles import Obstacle


@dataclass(frozen=True)
class Arena:
    """A rectangle of floor.

    Attributes:
        x: (low, high), metres.
        y: (low, high), metres.
        walls: whether its sides are walls that stop a chassis.
        obstacles: what stands on it.

    Raises:
        ValueError: a side is not finite or has no length.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    walls: bool = True
    obstacles: tuple[Obstacle, ...] = ()

    def __post_init__(self) -> None:
        for axis, (low, high) in (("x", self.x), ("y", self.y)):
            if not (np.isfinite(low) and np.isfinite(high) and low < high):
                raise ValueError(f"{axis} must be (low, high) in m with low < high, got ({low}, {high})")

    def contains(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether points (..., 2) lie on the floor, its border included."""
        x, y = points[..., 0], points[..., 1]
        return (x >= self.x[0]) & (x <= self.x[1]) & (y >= self.y[0]) & (y <= self.y[1])

    @property
    def corners(self) -> NDArray[np.float64]:
        """(4, 2) corners, metres, counter-clockwise."""
        (x0, x1), (y0, y1) = self.x, self.y
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])

    @property
    def half_planes(self) -> NDArray[np.float64]:
        """(4, 3) rows (n_x, n_y, c) of the south, east, north and west side, metres: inside is n.p >= c."""
        (x0, x1), (y0, y1) = self.x, self.y
        return np.array([[0.0, 1.0, y0], [-1.0, 0.0, -x1], [0.0, -1.0, -y1], [1.0, 0.0, x0]])

    @property
    def wall_planes(self) -> NDArray[np.float64]:
        """(4, 3) the half-planes of the sides that are walls, or (0, 3) where they are not."""
        return self.half_planes if self.walls else np.empty((0, 3))


ROBOTARIUM_FLOOR = Arena(x=(-1.6, 1.6), y=(-1.0, 1.0))
"""The Robotarium's floor (``rps`` 2.1)."""
