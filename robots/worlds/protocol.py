"""What every world offers, from the theorem's points to bodies with mass.

A world holds the state of all robots and advances it by one control period. It asks the controller for the body-frame
velocities of the projected points as often as its integrator needs: a sampled plant once per period, the continuous
model of the theorem at every stage of its Runge-Kutta step, with the time of the stage.
"""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Index = NDArray[np.intp]

NOTHING = -1
"""What a robot touches that touches nothing."""

Controller = Callable[[Real, Real, float], Real]
"""Maps projected points (..., n, 2), metres, unit heading vectors (..., n, 2), and the seconds since the control period
began, to body-frame velocities (..., n, 2), m/s, of the projected points."""


class UnsupportedVersionError(ImportError):
    """A package lacks what a world needs of it; the message says which versions have it."""


class World(Protocol):
    """A plant.

    Attributes:
        poses: (..., n, 3) x, y, theta of the axle centres, metres and radians. theta is continuous, not wrapped.
        points: (..., n, 2) projected points, metres.
        headings: (..., n, 2) unit vectors of the headings.
        contacts: (..., n) row of the robot that each robot touched in the last period, the smallest where it touched
            several; n for a wall or an obstacle alone, :data:`NOTHING` for nothing.
        wheel_speeds: (..., n, 2) left and right wheel speeds of the last period, rad/s; NaN where there are no wheels.
    """

    poses: Real
    points: Real
    headings: Real
    wheel_speeds: Real
    contacts: Index

    @property
    def seen(self) -> tuple[Real, Real]:
        """Projected points and headings as the controller is given them: the true ones, unless cameras are between."""
        ...

    def step(self, controller: Controller, period: float) -> None:
        """Advance the state by one control period, seconds."""
        ...

    def push(self, displacement: Real) -> None:
        """Push robots: (..., n, 2), metres, how far each would slide that nothing but its tyres stops.

        Without mass, it is there at once.
        """
        ...

    def stand(self, there: Sequence[bool]) -> None:
        """Which of the arena's obstacles (O,) are there from now on; worlds without contact know of none."""
        ...
