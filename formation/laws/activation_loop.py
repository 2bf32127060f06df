"""Sequential activation again, run by run: plain loops for whoever has a compiler.

:class:`formation.activation.SequentialActivation` is the protocol; this is the same over arrays (n, L) of L runs. It is
no protocol of its own, and knows of no compiler: the caller brings one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.activation import SequentialActivation

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_FOLLOWERS = agents.FIRST_ORDINARY


class Sequence(NamedTuple):
    """Who waits for whom.

    Attributes:
        neighbours: (n - 2, 2) rows i, j that each follower waits for; (0, 2) where nobody waits.
        rates: (n - 2,) at which the followers decay, 1/s.
        tolerance: distance from its place below which a follower counts as settled, metres.
    """

    neighbours: Index
    rates: Real
    tolerance: float


def sequence(activation: SequentialActivation | None, neighbours: Index) -> Sequence:
    """The constants of an activation among neighbours (n - 2, 2); None for agents that all begin at once."""
    if activation is None:
        return Sequence(np.empty((0, 2), dtype=np.int64), np.empty(0), 0.0)
    return Sequence(neighbours.astype(np.int64), activation.rates, activation.tolerance)


def hold(gx: Real, gy: Real, law: Sequence, begins: bool, active: Real, settled: Real) -> None:
    """Let those wait whose neighbours have not settled.

    Args:
        gx, gy: (n, L) the law's velocities of all agents, m/s, without v_r; 0 in the end for those who wait.
        begins: whether a control period begins: then who has settled is found anew.
        law: constants; a follower's neighbours stand before it.
        active, settled: (n, L) 1 or 0, brought up to date.
    """
    for row in range(len(law.rates)):
        k, i, j = _FOLLOWERS + row, law.neighbours[row, 0], law.neighbours[row, 1]
        for m in range(gx.shape[1]):
            x, y = gx[k, m], gy[k, m]
            if begins and active[k, m] > 0.0 and math.sqrt(x * x + y * y) / law.rates[row] < law.tolerance:
                settled[k, m] = 1.0
            if begins and settled[i, m] > 0.0 and settled[j, m] > 0.0:
                active[k, m] = 1.0
            gx[k, m], gy[k, m] = x * active[k, m], y * active[k, m]
