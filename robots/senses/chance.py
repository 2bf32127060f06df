"""Numbers that follow from a key and a place in a table, compiled: Philox 4x32-10 (Salmon, Moraes, Dror, Shaw 2011).

A generator that is asked in order would have to draw for all pairs of robots, sensed or not. This one is a function:
of any pair's number nothing needs to be drawn before it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, inlined
from robots.worlds.lanes import sine_cosine

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_ROUNDS = 10
_WORD = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_FIRST, _SECOND = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)  # multipliers
_STEP, _OTHER_STEP = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)  # of the key, from round to round
_UNIT = 2.0**-32


@compiled
def philox(
    a: np.uint64, b: np.uint64, c: np.uint64, d: np.uint64, key: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Four words of 32 bits from a counter of four such words and a key of two, the low one first."""
    low, high = key & _WORD, key >> _HALF
    for _ in range(_ROUNDS):
        first, second = _FIRST * a, _SECOND * c
        a, b, c, d = (second >> _HALF) ^ b ^ low, second & _WORD, (first >> _HALF) ^ d ^ high, first & _WORD
        low, high = (low + _STEP) & _WORD, (high + _OTHER_STEP) & _WORD
    return a, b, c, d


@compiled
def pair(key: np.uint64, observer: int, observed: int, position: float, bearing: float) -> tuple[float, ...]:
    """What is wrong with a measurement: cosine and sine of a rotation, then an offset, metres.

    Standard deviations as in :class:`robots.senses.noise.Noise`. Normal numbers by Box and Muller (1958), of words.
    """
    zero = np.uint64(0)
    a, b, c, d = philox(np.uint64(observer), np.uint64(observed), zero, zero, key)
    sine, cosine = sine_cosine(2.0 * math.pi * _UNIT * (np.float64(b) + 0.5))
    size = position * _size(a)
    x, y = size * cosine, size * sine
    _, cosine = sine_cosine(2.0 * math.pi * _UNIT * (np.float64(d) + 0.5))
    sine, cosine = sine_cosine(bearing * _size(c) * cosine)
    return cosine, sine, x, y


@inlined
def _size(word: np.uint64) -> float:
    """Length of a vector of two normal numbers."""
    return math.sqrt(-2.0 * math.log(_UNIT * (np.float64(word) + 0.5)))


@compiled
def pairs(key: np.uint64, observers: Index, observed: Index, position: float, bearing: float) -> Real:
    """(m, 4) what is wrong with measurements (m,) of one run, as :func:`pair` has it."""
    found = np.empty((len(observers), 4))
    for row in range(len(observers)):
        cosine, sine, x, y = pair(key, observers[row], observed[row], position, bearing)
        found[row, 0], found[row, 1], found[row, 2], found[row, 3] = cosine, sine, x, y
    return found
