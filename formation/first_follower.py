"""Laws of the first follower: what it makes of its one measurement, the leader's relative position.

With e_12 = p_2 - p_1 and the commanded displacement delta of agent 2 from agent 1, both in the first follower's own
frame, each law gives u_2 without the reference velocity v_r (paper, Section 3.3):

- ``stationary``: u_2 = 0 (shape control, Theorem 1).
- ``displacement``: u_2 = -(e_12 - delta), eq. (man). Steers scale and orientation.
- ``distance``: u_2 = -(|e_12|^2 - |delta|^2) e_12, eq. (distance). Steers the scale alone.
- ``bearing``: u_2 = P_b b*, b = e_12 / |e_12|, b* = delta / |delta|, P_b = I - b b^T, eq. (bearing). Steers the
  orientation alone.
"""

from collections.abc import Callable
from types import MappingProxyType

import numpy as np

from formation.plane import Complex

FirstFollowerLaw = Callable[[Complex, Complex], Complex]
"""Maps (e_12, delta) to u_2: complex arrays (...) in one frame, metres to metres per second."""


def stationary(e_12: Complex, delta: Complex) -> Complex:
    """u_2 = 0: the first follower holds its place and so fixes scale and orientation of the formation."""
    return np.zeros_like(e_12)


def displacement(e_12: Complex, delta: Complex) -> Complex:
    """u_2 = -(e_12 - delta), eq. (man). Its frame must be aligned with the frame of ``delta``: a compass."""
    return delta - e_12


def distance(e_12: Complex, delta: Complex) -> Complex:
    """u_2 = -(|e_12|^2 - |delta|^2) e_12, eq. (distance). Needs no compass: only the length of ``delta`` enters."""
    return -(np.abs(e_12) ** 2 - np.abs(delta) ** 2) * e_12


def bearing(e_12: Complex, delta: Complex) -> Complex:
    """u_2 = P_b b*, eq. (bearing). Needs a compass. NaN while the two agents coincide: no bearing exists there."""
    b = e_12 / np.abs(e_12)
    b_star = delta / np.abs(delta)
    return b_star - b * (np.conj(b) * b_star).real


FIRST_FOLLOWER_LAWS = MappingProxyType(
    {"stationary": stationary, "displacement": displacement, "distance": distance, "bearing": bearing}
)
"""The laws by the name that scenario files use."""

COMPASS_FREE = frozenset({"stationary", "distance"})
"""Laws that act in any local frame."""
