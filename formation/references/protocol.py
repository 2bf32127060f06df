"""References that change all the time: a leader on a curve, a formation that turns and scales on the way.

With the leader's path P(t) and the displacement of the first follower delta(t) = delta(0) D(t), D(0) = 1, complex, an
agent may be told, at any time t since the phase's begin,

    v_r(t) = P'(t),      delta(t),      mu(t) = delta'(t) / delta(t) = D'(t) / D(t) = sigma + i omega,

the velocity of the leader, the displacement, and the rate at which the formation scales (sigma) and turns (omega). A
piecewise-constant :class:`~formation.maneuver.Phase` has a constant v_r and delta, and mu = 0.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from formation.plane import Complex, Real


class Reference(Protocol):
    """What a formation is told to do, in seconds since its phase began. All take scalars or arrays of times.

    Attributes:
        cycle: seconds after which v_r, D and mu repeat; None where they never do.
        bends: (B,) times, seconds, increasing, at which v_r or D has a bend, so that mu may jump; none where all is
            smooth.
    """

    @property
    def cycle(self) -> float | None: ...

    @property
    def bends(self) -> Real: ...

    def path(self, t: Real | float) -> Complex:
        """P(t) - P(0), metres, how far the leader is from where it began."""
        ...

    def velocity(self, t: Real | float) -> Complex:
        """v_r(t), m/s."""
        ...

    def factor(self, t: Real | float) -> Complex:
        """D(t) = delta(t) / delta(0), the scale and the turn of the formation since the begin."""
        ...

    def rate(self, t: Real | float) -> Complex:
        """mu(t) = sigma + i omega, 1/s."""
        ...


NO_BENDS: Real = np.empty(0)
"""Of a reference that is smooth."""


def check_times(times: Real) -> None:
    """Refuse times (P,), seconds, at which nothing can be told one after another from the begin on.

    Raises:
        ValueError: fewer than two, the first is not 0, or one is not after the one before it.
    """
    wanted = "times must begin with 0 and increase, at least two of them"
    if len(times) < 2:
        raise ValueError(f"{wanted}, got {len(times)}")
    if times[0] != 0.0:
        raise ValueError(f"{wanted}, the first is {times[0]:g}")
    late = np.flatnonzero(~(np.diff(times) > 0.0))
    if late.size:
        place = int(late[0])
        raise ValueError(f"{wanted}, number {place + 2} is {times[place + 1]:g} after {times[place]:g}")


def pair_displacement(
    reference: Reference, e_12: complex, delta: complex | None, first_follower: str, feedforward: bool, t: Real | float
) -> Complex:
    """(...) p_2 - p_1 at times t (...), seconds, to which a first follower settles that follows without lag, metres.

    Args:
        reference: of the phase.
        e_12: p_2 - p_1 at the phase's begin.
        delta: delta(0); None for a stationary first follower.
        first_follower: name of its law.
        feedforward: whether it is told mu: what its law does not steer then scales and turns too.
    """
    factor = reference.factor(t)
    size, turn = np.abs(factor), factor / np.abs(factor)
    own_size, own_turn = (size, turn) if feedforward else (np.ones_like(size), np.ones_like(turn))
    if delta is None or first_follower == "stationary":
        return e_12 * own_size * own_turn
    if first_follower in ("displacement", "spiral"):
        return delta * factor
    if first_follower == "distance":
        return abs(delta) * size * own_turn * (e_12 / abs(e_12))
    return abs(e_12) * own_size * turn * (delta / abs(delta))
