"""What a robot measures: relative positions of its neighbours' projected points, in its own body frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots.senses.noise import draw_key

Real = NDArray[np.float64]


class RelativePositionSensor:
    """Range and bearing sensors of all robots at once.

    Args:
        edges: (m, 2) rows (observer, observed).
        position_noise: standard deviation of each coordinate of a measurement, metres.
        bearing_noise: standard deviation of a rotation of a measurement about its observer, radians.
    """

    def __init__(self, edges: ArrayLike, position_noise: float = 0.0, bearing_noise: float = 0.0) -> None:
        self._observer, self._observed = np.ascontiguousarray(np.asarray(edges, dtype=np.int64).T)
        self._position_noise, self._bearing_noise = position_noise, bearing_noise

    def measure(self, points: Real, headings: Real, own: Real | None = None) -> Real:
        """(..., m, 2) relative positions of projected points (..., n, 2), metres, each in its observer's body frame.

        ``own`` (..., n, 2) is where the observers are, where that is not where they are sensed by others.
        """
        p = points.view(np.complex128)[..., 0]
        here = p if own is None else own.view(np.complex128)[..., 0]
        frame = np.conj(headings.view(np.complex128)[..., 0])
        e = p.take(self._observed, axis=-1)
        e -= here.take(self._observer, axis=-1)
        e *= frame.take(self._observer, axis=-1)
        return e[..., None].view(np.float64)

    def key(self, rng: np.random.Generator) -> np.uint64 | None:
        """The key of one period's noise of one run; None for perfect sensors, which draw nothing."""
        return draw_key(rng) if self._position_noise or self._bearing_noise else None

    def noise(self, key: np.uint64) -> tuple[Real, Real]:
        """The noise of a key: unit rotations (m, 2) and offsets (m, 2), metres."""
        from robots.senses.chance import pairs  # numba is loaded only where it is used

        drawn = pairs(key, self._observer, self._observed, float(self._position_noise), float(self._bearing_noise))
        return drawn[:, :2].copy(), drawn[:, 2:].copy()


def disturb(relative: Real, noise: tuple[Real, Real] | None) -> Real:
    """Measurements (..., m, 2) with one period's noise, from :meth:`RelativePositionSensor.noise`."""
    if noise is None:
        return relative
    turn, offset = noise
    turned = relative.view(np.complex128) * turn.view(np.complex128)
    return turned.view(np.float64) + offset
