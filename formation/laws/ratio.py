"""Bearings and one ratio of distances: the paper's follower without any distance.

    u_k = s [(1 - w_k) b_ki + w_k r_k b_kj] / (1 + r_k)
    r_k = abs(e_kj) / abs(e_ki),   w_k = (p*_k - p*_i) / (p*_j - p*_i)

With equal robots r_k is a ratio of apparent sizes. The law is s (t_k - p_k) / (abs(e_ki) + abs(e_kj)), where t_k is the
place that the neighbours give: eq. (u) but for a positive factor, so the path is eq. (u)'s, straight while the
neighbours stand. Bearings alone cannot do this: in an own frame a static law of b_i and b_j is c b_i + d b_j with c, d
functions of the angle between them, so all places of rest on one side see the neighbours under one angle, an arc.

Source      ours, for what the paper names as future work, no distances: one angle is too little, with a ratio it does
Graph       leader-first-follower
Measures    bearings in local frames of one sense of rotation, and the ratio of the two distances at each follower
Proved      with settled neighbours abs(p_k - t_k) falls at the rate s / (abs(e_ki) + abs(e_kj)) from every start, and
            the speed is at most s max(abs(1 - w), abs(w)); moving neighbours are an input (ISS)
Fails       the rate falls with the size of the formation, as speed is bounded
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.base import Law
from formation.measurements import BEARING, RATIO
from formation.plane import Real, as_complex, as_vectors


class RatioLaw(Law):
    """Agents 1 and 2 stand still.

    Args:
        formation: the target formation.
        speed: s, m/s.

    Raises:
        ValueError: the speed is not positive.
    """

    name = "ratio"
    measures = (BEARING, RATIO)
    needs_handedness = True
    leaders = 2

    def __init__(self, formation: Framework, speed: float = 0.5) -> None:
        super().__init__(formation)
        if not speed > 0.0:
            raise ValueError(f"speed must be positive, got {speed:g} m/s")
        self._speed = speed
        self._rows = formation.graph.corners
        to_i, to_j = -self._desired[self._rows].T
        self._w = -to_i / (to_j - to_i)

    def __call__(self, bearing: Real, ratio: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from bearings (..., 2n - 3, 2) and ratios (..., n - 2)."""
        b = as_complex(bearing)
        u = np.zeros((*b.shape[:-1], self._n), dtype=np.complex128)
        towards = (1.0 - self._w) * b[..., self._rows[:, 0]] + self._w * ratio * b[..., self._rows[:, 1]]
        u[..., agents.FIRST_ORDINARY :] = self._speed * towards / (1.0 + ratio)
        return as_vectors(u)
