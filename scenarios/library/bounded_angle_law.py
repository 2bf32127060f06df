"""The paper's angle law with a bound on each follower's speed: a law of one's own, to copy and change.

    u_k = v_max tanh(|g_k| / v_max) g_k / |g_k|,   g_k = -A_k^T (A_i e_ki + A_j e_kj)      followers k >= 3, eq. (u)

Near the shape u_k is g_k, so the rates are the paper's; far from it no follower is asked to go faster than v_max, where
eq. (u) asks for a speed in proportion to the distance. The bound keeps the direction, so that u_k, like g_k, turns with
the frame that agent k measures in.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation import TargetFormation, follower_gains

Real = NDArray[np.float64]


class BoundedAngleLaw:
    """Eq. (u), no faster than ``v_max``; agents 1 and 2 stand still.

    Args:
        target: the target formation.
        v_max: bound on each follower's speed, m/s.
    """

    needs_compass = False

    def __init__(self, target: TargetFormation, v_max: float = 0.1) -> None:
        if not v_max > 0.0:
            raise ValueError(f"v_max must be positive, got {v_max:g} m/s")
        self._gains = follower_gains(target)
        self._v_max = v_max

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., 2n - 3, 2), metres.

        Row 0 of ``relative`` is what agent 2 measures; then come two rows for each follower 3, 4, ..., n.
        """
        pairs = relative[..., 1:, :].reshape(*relative.shape[:-2], -1, 2, 2)
        e = pairs[..., 0] + 1j * pairs[..., 1]  # vectors as complex numbers, as the gains are: (..., n - 2, 2)
        g = (self._gains * e).sum(axis=-1)
        u = self._bound(np.abs(g)) * g
        velocities = np.zeros((*u.shape[:-1], u.shape[-1] + 2, 2))
        velocities[..., 2:, 0], velocities[..., 2:, 1] = u.real, u.imag
        return velocities

    def _bound(self, speed: Real) -> Real:
        """tanh(x) / x for x = speed / v_max: from 1 at rest down to v_max / speed."""
        x = speed / self._v_max
        return np.divide(np.tanh(x), x, out=np.ones_like(x), where=x > 0.0)
