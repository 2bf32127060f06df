"""The differential drive: wheel speeds, twists and what happens at the wheels' limit.

    v = r (w_right + w_left) / 2        omega = r (w_right - w_left) / b

with wheel radius r and base length b. Wheel speeds are (..., 2) arrays (left, right), rad/s; twists are (..., 2) arrays
(v, omega), m/s and rad/s, of the axle's centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Saturation = Literal["scale", "clip"]


@dataclass(frozen=True)
class DifferentialDrive:
    """Geometry and limit of two driven wheels on one axle.

    Attributes:
        wheel_radius: r, metres.
        base_length: b, distance between the wheels, metres.
        wheel_speed_limit: largest speed of either wheel in either direction, rad/s; (n,) of robots that differ.

    Raises:
        ValueError: a quantity is not finite and positive.
    """

    wheel_radius: float
    base_length: float
    wheel_speed_limit: float | Real

    def __post_init__(self) -> None:
        for field, unit in (("wheel_radius", "m"), ("base_length", "m"), ("wheel_speed_limit", "rad/s")):
            value = getattr(self, field)
            if not (np.isfinite(value) & (np.asarray(value) > 0.0)).all():
                raise ValueError(f"{field} must be a positive number of {unit}, got {value}")

    @cached_property
    def to_twist(self) -> Real:
        """(2, 2) matrix that maps wheel speeds (left, right) to the twist (v, omega)."""
        r, b = self.wheel_radius, self.base_length
        return np.array([[r / 2.0, r / 2.0], [-r / b, r / b]])

    @cached_property
    def to_wheels(self) -> Real:
        """(2, 2) matrix that maps the twist (v, omega) to wheel speeds (left, right)."""
        r, b = self.wheel_radius, self.base_length
        return np.array([[1.0 / r, -b / (2.0 * r)], [1.0 / r, b / (2.0 * r)]])

    def twist(self, wheel_speeds: Real) -> Real:
        """Twists (..., 2) of wheel speeds (..., 2)."""
        return wheel_speeds @ self.to_twist.T

    def wheel_speeds(self, twist: Real) -> Real:
        """Wheel speeds (..., 2) of twists (..., 2), without limit."""
        return twist @ self.to_wheels.T

    @property
    def speed_limit(self) -> float | Real:
        """Largest forward speed, m/s: both wheels at their limit; (n,) of robots that differ."""
        return self.wheel_radius * self.wheel_speed_limit

    @property
    def turn_limit(self) -> float | Real:
        """Largest turning speed, rad/s: the wheels at opposite limits."""
        return 2.0 * self.speed_limit / self.base_length

    def saturate(self, wheel_speeds: Real, how: Saturation) -> Real:
        """Wheel speeds (..., 2) within the limit.

        ``"scale"`` slows both wheels of a robot by one factor and so keeps the curvature of its path, ``"clip"`` cuts
        each wheel by itself, as the Robotarium does.
        """
        limit = self.wheel_speed_limit
        if how == "clip":
            each = np.asarray(limit)[..., None]
            return np.clip(wheel_speeds, -each, each)
        speed = np.abs(wheel_speeds)
        fastest = np.maximum(speed[..., 0], speed[..., 1])
        return wheel_speeds * (limit / np.maximum(fastest, limit))[..., None]
