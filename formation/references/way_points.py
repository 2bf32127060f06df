"""Way-points: a leader that is told places and times, and a formation that scales and turns on the way."""

from __future__ import annotations

import numpy as np

from formation.plane import Complex, Real
from formation.references.protocol import NO_BENDS, check_times


class WayPoints:
    """A leader through given places at given times, and a formation that scales and turns on the way.

    Between them the path, the logarithm of the scale and the turn are cubic splines, twice continuously
    differentiable (scipy's ``CubicSpline``). The reference begins and ends at rest, or, ``moving``, as the points next
    to its ends suggest (not-a-knot), and stays at rest after the last.
    """

    def __init__(self, times: Real, places: Complex, scales: Real, turns: Real, moving: bool = False) -> None:
        """Interpolate.

        Args:
            times: (P,) seconds, increasing, the first is 0; P >= 2.
            places: (P,) of the leader, complex metres; differences from the first count.
            scales: (P,) of the formation, positive; ratios to the first count.
            turns: (P,) of the formation, radians, not wrapped; differences from the first count.
            moving: whether it need not be at rest at its ends.
        """
        from scipy.interpolate import CubicSpline

        check_times(times)
        if not (scales > 0.0).all():
            raise ValueError("scales must be positive")
        log_factor = np.log(scales / scales[0]) + 1j * (turns - turns[0])
        self._end = float(times[-1])
        self._bends = times[-1:] if moving else NO_BENDS
        ends = "not-a-knot" if moving else "clamped"
        self._path = CubicSpline(times, places - places[0], bc_type=ends)
        self._log_factor = CubicSpline(times, log_factor, bc_type=ends)

    @property
    def cycle(self) -> float | None:
        return None

    @property
    def bends(self) -> Real:
        return self._bends

    def path(self, t: Real | float) -> Complex:
        return np.asarray(self._path(np.minimum(t, self._end)), dtype=np.complex128)

    def velocity(self, t: Real | float) -> Complex:
        return np.where(np.asarray(t) < self._end, self._path(np.minimum(t, self._end), 1), 0.0)

    def factor(self, t: Real | float) -> Complex:
        return np.exp(self._log_factor(np.minimum(t, self._end)))

    def rate(self, t: Real | float) -> Complex:
        return np.where(np.asarray(t) < self._end, self._log_factor(np.minimum(t, self._end), 1), 0.0)
