"""Angle errors over a trailing window: what a run with noisy sensors is judged by.

Noise keeps a formation moving about its shape, so that the last sample meets the goal by luck. The mean of each signed
angle error over some seconds is what the shape is off by; the root mean square beside it says how far it moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import wrap

Real = NDArray[np.float64]

WINDOW = 10.0
"""Seconds of the window, or as many as the run has had."""

ROUNDING = 1e-9
"""Seconds by which two times that ought to be equal may differ."""


@dataclass(frozen=True, eq=False)
class Window:
    """Angle errors over the window that ends at each time.

    Attributes:
        mean: (T, ..., m) of each signed error, in (-pi, pi], radians; one that passes from pi to -pi goes on.
        rms: (T, ..., m) of each error, radians.
    """

    mean: Real
    rms: Real


def trailing(t: Real, errors: Real, length: float = WINDOW) -> Window:
    """The window of ``length`` seconds at times t (T,), seconds, of angle errors (T, ..., m), radians."""
    begin = np.searchsorted(t, t - length + ROUNDING)  # samples in (t - length, t]
    count = (np.arange(1, len(t) + 1) - begin).reshape(-1, *[1] * (errors.ndim - 1))
    mean = _sums(np.unwrap(errors, axis=0), begin) / count
    square = _sums(errors**2, begin) / count
    return Window(wrap(mean), np.sqrt(np.maximum(square, 0.0)))


def _sums(values: Real, begin: NDArray[np.intp]) -> Real:
    """(T, ...) of values (T, ...), the sum from row ``begin`` (T,) to each row."""
    total = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
    return total[1:] - total[begin]
