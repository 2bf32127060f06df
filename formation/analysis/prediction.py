"""What Theorem 1 says before anything moves: the end configuration and each follower's rate.

The end configuration p_dagger = c R(theta) p* + xi is fixed by where the leader and the first follower end, because a
similarity of the plane has exactly the four degrees of freedom of two points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.plane import Real, as_complex, as_vectors
from formation.target import TargetFormation


@dataclass(frozen=True)
class Similarity:
    """q = c R(theta) p + xi, an element of the shape's orbit (paper, eq. (te)).

    Attributes:
        scale: c > 0.
        angle: theta in [0, 2 pi), radians.
        translation: xi, metres.
    """

    scale: float
    angle: float
    translation: tuple[float, float]

    def __call__(self, points: Real) -> Real:
        """Move points (..., 2), metres."""
        turned = self.scale * np.exp(1j * self.angle) * as_complex(points)
        return as_vectors(turned + complex(*self.translation))


def end_similarity(target: Framework, leader: Real, first_follower: Real) -> Similarity:
    """c, theta and xi of the end configuration (paper, eq. (cdager) to the end of Section 3.2).

    Args:
        target: the target formation.
        leader: (2,) where agent 1 ends, metres; p_1(0) in shape control.
        first_follower: (2,) where agent 2 ends, metres; p_2(0) in shape control.

    Raises:
        ValueError: the two agents coincide; Theorem 1 needs p_1(0) != p_2(0).
    """
    p_1, p_2 = as_complex(leader), as_complex(first_follower)
    if p_1 == p_2:
        raise ValueError(
            f"leader and first follower coincide at ({p_1.real:g}, {p_1.imag:g}); Theorem 1 needs p_1(0) != p_2(0)"
        )
    star_1, star_2 = as_complex(target.positions[: agents.FIRST_ORDINARY])
    factor = (p_1 - p_2) / (star_1 - star_2)
    xi = p_1 - factor * star_1
    return Similarity(
        scale=float(np.abs(factor)),
        angle=float(np.mod(np.angle(factor), 2.0 * np.pi)),
        translation=(float(xi.real), float(xi.imag)),
    )


def end_configuration(target: Framework, leader: Real, first_follower: Real) -> Real:
    """(n, 2) the configuration p_dagger to which Theorem 1 says the agents converge, metres."""
    return end_similarity(target, leader, first_follower)(target.positions)


def fit_similarity(target: Framework, points: Real) -> tuple[Real, Real, Real]:
    """The similarity that carries the target closest to points (..., n, 2), in the sense of least squares.

    Returns:
        Scale (...), angle (...) in [0, 2 pi), radians, and centroid (..., 2) of the points, metres.
    """
    p, star = as_complex(points), as_complex(target.positions)
    centred = star - star.mean()
    factor = (p @ np.conj(centred)) / (np.abs(centred) ** 2).sum()
    return np.abs(factor), np.mod(np.angle(factor), 2.0 * np.pi), as_vectors(p.mean(axis=-1))


def decay_rates(target: TargetFormation) -> Real:
    """(n - 2,) rate sin^2(a_k), 1/s, at which |p_k - p_k_dagger| decays once k's neighbours have settled.

    The paper's 2 sin^2 is the rate of the Lyapunov function V = |p_k - p_k_dagger|^2 / 2.
    """
    return np.sin(target.follower_angles) ** 2
