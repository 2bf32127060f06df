"""What a robot measures: relative positions of its neighbours' projected points, in its own body frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]


class RelativePositionSensor:
    """Range and bearing sensors of all robots at once.

    Args:
        edges: (m, 2) rows (observer, observed).
        position_noise: standard deviation of each coordinate of a measurement, metres.
        bearing_noise: standard deviation of a rotation of a measurement about its observer, radians.
    """

    def __init__(self, edges: ArrayLike, position_noise: float = 0.0, bearing_noise: float = 0.0) -> None:
        self._observer, self._observed = np.asarray(edges, dtype=np.intp).T
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

    def noise(self, rng: np.random.Generator) -> tuple[Real, Real] | None:
        """One period's noise of one run: unit rotations (m, 2) and offsets (m, 2), metres.

        None for perfect sensors, which draw nothing.
        """
        if self._position_noise == 0.0 and self._bearing_noise == 0.0:
            return None
        m = len(self._observer)
        turn = np.exp(1j * rng.normal(0.0, self._bearing_noise, m))
        return turn[:, None].view(np.float64), rng.normal(0.0, self._position_noise, (m, 2))


def disturb(relative: Real, noise: tuple[Real, Real] | None) -> Real:
    """Measurements (..., m, 2) with one period's noise, from :meth:`RelativePositionSensor.noise`."""
    if noise is None:
        return relative
    turn, offset = noise
    turned = relative.view(np.complex128) * turn.view(np.complex128)
    return turned.view(np.float64) + offset
