"""Measurements that are some control periods old, compiled: :mod:`robots.own_motion` for lanes, without its noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled
from robots.own_motion import MEASURED, TURN, UNKNOWN
from robots.worlds.lanes import COS, NOW, PX, SEEN_COS, SEEN_X, Senses

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_SENSES = {
    UNKNOWN: Senses(SEEN_X, SEEN_COS, SEEN_X),
    TURN: Senses(SEEN_X, COS, SEEN_X),
    MEASURED: Senses(PX, COS, SEEN_X),
}
"""What of the state a robot senses late that knows so much of its own motion."""

_KEPT = (PX, PX + 1, COS, COS + 1)


class Late(NamedTuple):
    """What robots remember.

    Attributes:
        senses: fields of the state that are sensed.
        states: (d, 4, n, L) points and headings of the last d control periods, in turns.
        turn: (1,) where the oldest stands.
    """

    senses: Senses
    states: Real
    turn: Index


def late(state: Real, delay: int, knows: str) -> Late:
    """Measurements that lag by so many control periods; until they have passed, of the state (FIELDS, n, L) of now."""
    states = np.repeat(state[None, _KEPT], delay, axis=0)
    return Late(_SENSES[knows] if delay else NOW, states, np.zeros(1, dtype=np.int64))


@compiled
def remember(state: Real, kept: Late) -> None:
    """Write where robots were when they were seen, and keep where they are."""
    oldest = kept.states[kept.turn[0]]
    kept.turn[0] = (kept.turn[0] + 1) % len(kept.states)
    for field in range(4):
        now = (PX if field < 2 else COS - 2) + field
        for i in range(state.shape[1]):
            for m in range(state.shape[2]):
                state[SEEN_X + field, i, m] = oldest[field, i, m]
                oldest[field, i, m] = state[now, i, m]
