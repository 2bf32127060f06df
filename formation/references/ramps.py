"""What is told at times, with straight lines in between: v_r, scale and turn that change steadily."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation.plane import Complex, Real
from formation.references.protocol import check_times


class Ramps:
    """A leader whose velocity v_r(t), and a formation whose scale and turn, are piecewise linear.

    delta(t) = delta(0) s(t) e^{i theta(t)}. After the last time the last velocity, scale and turn are kept.
    """

    def __init__(self, times: Real, velocities: Complex, scales: Real | None = None, turns: Real | None = None) -> None:
        """Join what is told.

        Args:
            times: (P,) seconds, increasing, the first is 0; P >= 2.
            velocities: (P,) v_r at these times, complex m/s.
            scales: (P,) of the formation, positive; ratios to the first count. Constant where absent.
            turns: (P,) of the formation, radians, not wrapped; differences from the first count. Constant where absent.

        Raises:
            ValueError: times that do not begin with 0 and increase, or scales that are not positive.
        """
        check_times(times)
        scales = np.ones(len(times)) if scales is None else scales
        turns = np.zeros(len(times)) if turns is None else turns
        if not (scales > 0.0).all():
            raise ValueError("scales must be positive")
        self._times, self._velocities = times, velocities
        self._scales, self._turns = scales / scales[0], turns - turns[0]
        lengths = np.diff(times)
        self._ways = np.concatenate([[0.0], np.cumsum((velocities[1:] + velocities[:-1]) * lengths / 2.0)])
        self._growths, self._omegas = (np.append(np.diff(each) / lengths, 0.0) for each in (self._scales, self._turns))

    @property
    def cycle(self) -> float | None:
        return None

    @property
    def bends(self) -> Real:
        return self._times[1:]

    def path(self, t: Real | float) -> Complex:
        now = np.asarray(t, dtype=np.float64)
        piece = self._piece(now)
        elapsed = now - self._times[piece]
        return np.asarray(self._ways[piece] + elapsed * (self._velocities[piece] + self.velocity(now)) / 2.0)

    def velocity(self, t: Real | float) -> Complex:
        return np.asarray(np.interp(t, self._times, self._velocities), dtype=np.complex128)

    def factor(self, t: Real | float) -> Complex:
        turn = np.exp(1j * np.interp(t, self._times, self._turns))
        return np.asarray(np.interp(t, self._times, self._scales) * turn, dtype=np.complex128)

    def rate(self, t: Real | float) -> Complex:
        piece = self._piece(np.asarray(t, dtype=np.float64))
        sigma = self._growths[piece] / np.interp(t, self._times, self._scales)
        return np.asarray(sigma + 1j * self._omegas[piece], dtype=np.complex128)

    def _piece(self, t: Real) -> NDArray[np.intp]:
        """(...) index of the straight line on which times (...) lie; where two meet, of the later one."""
        return np.clip(np.searchsorted(self._times, t, side="right") - 1, 0, len(self._times) - 1)
