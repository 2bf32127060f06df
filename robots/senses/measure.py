"""Relative positions along the edges of a graph, compiled: :class:`robots.sensors.RelativePositionSensor` for lanes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled
from robots.senses.chance import pair
from robots.senses.noise import Noise
from robots.worlds.lanes import Senses

Real = NDArray[np.float64]
Index = NDArray[np.int64]


@compiled
def measure(state: Real, edges: Index, senses: Senses, noise: Noise, e: Real) -> None:
    """Write the relative positions (2, m, L), metres, of what is observed, each in its observer's frame.

    Args:
        state: (FIELDS, n, L), see :mod:`robots.worlds.lanes`.
        edges: (m, 2) rows (observer, observed).
        senses: which fields of the state are sensed.
        noise: of this period, the same that the safety filter has.
    """
    own, frame, other = senses
    noisy = noise.position > 0.0 or noise.bearing > 0.0
    for row in range(len(edges)):
        k, i = edges[row, 0], edges[row, 1]
        for m in range(state.shape[2]):
            c, s = state[frame, k, m], state[frame + 1, k, m]
            dx, dy = state[other, i, m] - state[own, k, m], state[other + 1, i, m] - state[own + 1, k, m]
            e[0, row, m], e[1, row, m] = dx * c + dy * s, dy * c - dx * s
        if noisy:
            for m in range(state.shape[2]):
                cosine, sine, x, y = pair(noise.keys[m], k, i, noise.position, noise.bearing)
                ex, ey = e[0, row, m], e[1, row, m]
                e[0, row, m], e[1, row, m] = ex * cosine - ey * sine + x, ey * cosine + ex * sine + y
