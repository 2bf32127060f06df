"""How late and how rarely a loop may be told: margins that its modes alone decide.

A mode lambda of dx/dt = lambda x, whose measurement is tau old, stands at the edge of stability where
i omega = lambda e^{-i omega tau}; held over a period T with d periods of delay, where
e^{i phi (d + 1)} - e^{i phi d} = T lambda. With psi = abs(arg lambda), above pi/2 for a mode that decays at all,

    tau < (psi - pi/2) / abs(lambda)            T abs(lambda) < 2 sin((2 psi - pi) / (2 (2 d + 1)))

For the modes -a of the angle law that is tau < pi / (2 a) and a T < 2 sin(pi / (2 (2 d + 1))): 2 without delay.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]


def delay_margin(modes: ArrayLike) -> float:
    """The delay, seconds, of all measurements that modes (...), 1/s, stand; infinite for none, 0 for one that grows."""
    size, spare = _spare(modes)
    return float((spare / size).min(initial=np.inf))


def longest_period(modes: ArrayLike, delay_periods: int = 0) -> float:
    """The control period, seconds, below which held commands of measurements ``delay_periods`` old decay."""
    size, spare = _spare(modes)
    return float((2.0 * np.sin(spare / (2 * delay_periods + 1)) / size).min(initial=np.inf))


def most_periods(modes: ArrayLike, period: float) -> int | None:
    """The largest delay, in control periods of ``period`` seconds, at which held commands decay; None for any delay.

    -1 where they do not even without one.
    """
    size, spare = _spare(modes)
    if not size.size:
        return None
    reach = period * size / 2.0
    room = np.where(reach < 1.0, spare / np.arcsin(np.minimum(reach, 1.0)), 0.0)
    return int(np.ceil((room.min() - 1.0) / 2.0)) - 1


def _spare(modes: ArrayLike) -> tuple[Real, Real]:
    """Magnitude of each mode, 1/s, and the angle by which it is beyond the imaginary axis; 0 where it is not."""
    given = np.asarray(modes, dtype=np.complex128).ravel()
    return np.abs(given), np.maximum(np.abs(np.angle(given)) - np.pi / 2.0, 0.0)
