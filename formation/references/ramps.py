"""A velocity that is told at times, straight lines in between: starts, stops and bends without a jump of v_r."""

from __future__ import annotations

import numpy as np

from formation.plane import Complex, Real


class Ramps:
    """A leader whose velocity v_r(t) is piecewise linear; the formation neither scales nor turns.

    After the last time the last velocity is kept.
    """

    def __init__(self, times: Real, velocities: Complex) -> None:
        """Join velocities.

        Args:
            times: (P,) seconds, increasing, the first is 0; P >= 2.
            velocities: (P,) v_r at these times, complex m/s.

        Raises:
            ValueError: times that do not begin with 0 and increase.
        """
        if len(times) < 2 or times[0] != 0.0 or not (np.diff(times) > 0.0).all():
            raise ValueError("times must begin with 0 and increase, at least two of them")
        self._times, self._velocities = times, velocities
        lengths = np.diff(times)
        self._ways = np.concatenate([[0.0], np.cumsum((velocities[1:] + velocities[:-1]) * lengths / 2.0)])

    @property
    def cycle(self) -> float | None:
        return None

    def path(self, t: Real | float) -> Complex:
        now = np.asarray(t, dtype=np.float64)
        piece = np.clip(np.searchsorted(self._times, now, side="right") - 1, 0, len(self._times) - 1)
        elapsed = now - self._times[piece]
        return np.asarray(self._ways[piece] + elapsed * (self._velocities[piece] + self.velocity(now)) / 2.0)

    def velocity(self, t: Real | float) -> Complex:
        return np.asarray(np.interp(t, self._times, self._velocities), dtype=np.complex128)

    def factor(self, t: Real | float) -> Complex:
        return np.ones(np.shape(t), dtype=np.complex128)

    def rate(self, t: Real | float) -> Complex:
        return np.zeros(np.shape(t), dtype=np.complex128)
