"""The near-identity diffeomorphism (NID): a unicycle seen as a single integrator.

The point at distance l ahead of the axle's centre x,

    p = x + l (cos theta, sin theta),      dp/dt = R(theta) diag(1, l) (v, omega),

can be given any velocity. In the body frame the map is diag(1, l) and its inverse v = u_x, omega = u_y / l: no
trigonometry (Olfati-Saber 2002; Pickem et al. 2017, "The Robotarium").
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


@dataclass(frozen=True)
class NearIdentityDiffeomorphism:
    """The map between twists of the axle's centre and velocities of the projected point.

    Attributes:
        projection_distance: l, metres ahead of the axle; (n,) of robots that differ.

    Raises:
        ValueError: ``projection_distance`` is not finite and positive; the map is singular at 0.
    """

    projection_distance: float | Real

    def __post_init__(self) -> None:
        if not (np.isfinite(self.projection_distance) & (np.asarray(self.projection_distance) > 0.0)).all():
            raise ValueError(f"projection_distance must be a positive number of m, got {self.projection_distance}")

    @property
    def ahead(self) -> Real:
        """(1,) or (n, 1) l, metres, to multiply vectors of robots with."""
        return np.asarray(self.projection_distance)[..., None]

    @cached_property
    def to_twist(self) -> Real:
        """(2, 2) matrix diag(1, 1/l) from a body-frame velocity of the projected point to the twist (v, omega).

        (n, 2, 2) of robots that differ.
        """
        each = np.asarray(self.projection_distance)
        matrix = np.zeros((*each.shape, 2, 2))
        matrix[..., 0, 0], matrix[..., 1, 1] = 1.0, 1.0 / each
        return matrix

    def twist(self, velocity: Real) -> Real:
        """Twists (v, omega) (..., 2) of body-frame velocities (..., 2) of the projected point, m/s."""
        return mapped(velocity, self.to_twist)

    def velocity(self, twist: Real) -> Real:
        """Body-frame velocities (..., 2) of the projected point, m/s, of twists (..., 2)."""
        return twist * np.stack(np.broadcast_arrays(1.0, self.projection_distance), axis=-1)

    def turning_limit(self, period: float, delay_periods: int = 0) -> float:
        """The speed, m/s, above which the heading does not settle along the velocity that a robot is told.

        The heading error obeys phi(k + 1) = phi(k) - (v T / l) sin phi(k - d): v T / l < 2 sin(pi / (2 (2 d + 1))), 2
        without delay. The delay d is that of the frame in which the command was computed: 0 where the robot undoes its
        own turn.
        """
        return (
            2.0
            * float(np.min(self.projection_distance))
            / period
            * float(np.sin(np.pi / (2.0 * (2 * delay_periods + 1))))
        )

    def project(self, poses: Real) -> Real:
        """Projected points (..., 2) of poses (..., 3) of the axle's centre."""
        theta = poses[..., 2]
        offset = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
        return poses[..., :2] + self.ahead * offset

    def poses(self, points: Real, theta: Real) -> Real:
        """Poses (..., 3) of the axle's centre whose projected points are (..., 2) at headings theta (...), radians."""
        offset = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
        return np.concatenate([points - self.ahead * offset, theta[..., None]], axis=-1)


def mapped(vectors: Real, matrix: Real) -> Real:
    """Vectors (..., n, 2) times a matrix (2, 2) of all robots, or times each robot's own (n, 2, 2)."""
    return vectors @ matrix if matrix.ndim == 2 else np.einsum("...ni,nij->...nj", vectors, matrix)
