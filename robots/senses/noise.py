"""The noise of one control period, before it is drawn: nobody draws what nobody senses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Noise(NamedTuple):
    """One period's noise of what robots measure of other robots, walls and obstacles, in the observer's frame.

    What observer i gets of thing j follows from the key and from (i, j) alone, see :mod:`robots.senses.chance`: it is
    the same whoever asks for it, law or filter, and however many others are measured.

    Attributes:
        keys: (...) of each run.
        position: standard deviation of each coordinate of an offset, metres.
        bearing: standard deviation of a rotation, radians.
    """

    keys: NDArray[np.uint64]
    position: float
    bearing: float


def draw_key(rng: np.random.Generator) -> np.uint64:
    """The key of one control period of a run."""
    return rng.integers(0, 2**64, dtype=np.uint64)


def silence(runs: int) -> Noise:
    """Of perfect sensors."""
    return Noise(np.zeros(runs, dtype=np.uint64), 0.0, 0.0)
