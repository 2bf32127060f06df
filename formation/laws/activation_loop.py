"""Sequential activation again, run by run: plain loops for whoever has a compiler.

:class:`formation.activation.SequentialActivation` is the protocol; this is the same over arrays (n, L) of L runs. It is
no protocol of its own, and knows of no compiler: the caller brings one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from formation import agents

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_FOLLOWERS = agents.FIRST_ORDINARY


def hold(
    gx: Real, gy: Real, factors: Real, edges: Index, tolerance: float, begins: bool, active: Real, settled: Real
) -> None:
    """Let those wait whose neighbours have not settled.

    Args:
        gx, gy: (n, L) the law's velocities of all agents, m/s, without v_r; 0 in the end for those who wait.
        factors: (n - 2, 4) of :class:`formation.laws.angle_loop.Gains`: both gains of a follower add up to its rate.
        edges: (2n - 3, 2) rows (observer, observed) in the order of :attr:`SensingGraph.edges`.
        tolerance: distance from its place below which a follower counts as settled, metres.
        begins: whether a control period begins: then who has settled is found anew.
        active, settled: (n, L) 1 or 0, brought up to date.
    """
    for row in range(len(factors)):
        k, i, j = _FOLLOWERS + row, edges[1 + 2 * row, 1], edges[2 + 2 * row, 1]
        near = tolerance * (factors[row, 0] + factors[row, 2])
        for m in range(gx.shape[1]):
            x, y = gx[k, m], gy[k, m]
            if begins and active[k, m] > 0.0 and math.sqrt(x * x + y * y) < near:
                settled[k, m] = 1.0
            if begins and settled[i, m] > 0.0 and settled[j, m] > 0.0:
                active[k, m] = 1.0
            gx[k, m], gy[k, m] = x * active[k, m], y * active[k, m]
