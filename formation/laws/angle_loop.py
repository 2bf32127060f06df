"""The angle law again, agent by agent and run by run: plain loops for whoever has a compiler.

:class:`formation.laws.angle.AngleLaw` is the law; this is the same arithmetic over arrays (n, L) of L runs, for
experiments that advance by the million. It is no law of its own, and knows of no compiler: the caller brings one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.laws.angle import AngleLaw
from formation.laws.feedforward import shares
from formation.laws.first_follower import BESIDE
from formation.target import TargetFormation

Real = NDArray[np.float64]

FIRST_FOLLOWERS = ("stationary", "displacement", "distance", "bearing", "spiral")
"""The laws of :data:`formation.EDGE_LAWS`, by the number that the loops use."""

_LEADER, _FIRST, _FOLLOWERS = agents.LEADER, agents.FIRST_FOLLOWER, agents.FIRST_ORDINARY


class Gains(NamedTuple):
    """The law of one formation.

    Attributes:
        factors: (n - 2, 4) real and imaginary part of -A_k^T A_i, then of -A_k^T A_j, 1/s.
        shares: (n - 2, 2) real and imaginary part of f_k, see :mod:`formation.laws.feedforward`.
        first_follower: place in :data:`FIRST_FOLLOWERS`.
    """

    factors: Real
    shares: Real
    first_follower: int


def gains(law: AngleLaw, target: TargetFormation, first_follower: str) -> Gains:
    """The constants of a law with its target and its first follower's name."""
    factors = np.ascontiguousarray(law.gains).view(np.float64).reshape(-1, 4)
    return Gains(factors, shares(target).view(np.float64).reshape(-1, 2), FIRST_FOLLOWERS.index(first_follower))


def feedback(
    e: Real,
    c: Real,
    s: Real,
    law: Gains,
    delta_x: float,
    delta_y: float,
    rate_x: float,
    rate_y: float,
    gx: Real,
    gy: Real,
) -> None:
    """Velocities in body frames, m/s, without v_r, with what :class:`formation.laws.feedforward.FeedForward` adds.

    A follower's mu f_k (e_kj - e_ki) is a change of its two gains.

    Args:
        e: (2, 2n - 3, L) relative positions, metres, each in its observer's frame, in the row order of
            :attr:`SensingGraph.edges`.
        c, s: (n, L) cosine and sine of each agent's heading: its compass.
        law: constants.
        delta_x, delta_y: displacement that the first follower is told, metres, in the common frame.
        rate_x, rate_y: mu that all are told, 1/s.
        gx, gy: (n, L) out.
    """
    runs = gx.shape[1]
    for m in range(runs):
        gx[_LEADER, m], gy[_LEADER, m] = 0.0, 0.0
        gx[_FIRST, m], gy[_FIRST, m] = 0.0, 0.0
    if law.first_follower > 0:
        size2 = delta_x * delta_x + delta_y * delta_y
        size = math.sqrt(size2)
        for m in range(runs):
            ch, sh = c[_FIRST, m], s[_FIRST, m]
            ex, ey = -e[0, 0, m], -e[1, 0, m]
            tx, ty = delta_x * ch + delta_y * sh, delta_y * ch - delta_x * sh
            e2 = ex * ex + ey * ey
            if law.first_follower == 1:
                gx[_FIRST, m], gy[_FIRST, m] = tx - ex, ty - ey
            elif law.first_follower == 2:
                pull = size2 - e2
                gx[_FIRST, m], gy[_FIRST, m] = pull * ex, pull * ey
            elif law.first_follower == 4:
                along, across = ex * tx + ey * ty, ey * tx - ex * ty
                turned = math.atan2(across - BESIDE * along, along + BESIDE * across) + BESIDE
                grown = 0.5 * math.log(e2 / size2)
                gx[_FIRST, m], gy[_FIRST, m] = ey * turned - ex * grown, -ex * turned - ey * grown
            else:
                length = math.sqrt(e2)
                bx, by, wx, wy = ex / length, ey / length, tx / size, ty / size
                along = bx * wx + by * wy
                gx[_FIRST, m], gy[_FIRST, m] = wx - bx * along, wy - by * along
    for m in range(runs):
        ex, ey = e[0, 0, m], e[1, 0, m]
        gx[_FIRST, m], gy[_FIRST, m] = (
            gx[_FIRST, m] - rate_x * ex + rate_y * ey,
            gy[_FIRST, m] - rate_x * ey - rate_y * ex,
        )
    for row in range(len(law.factors)):
        k, first = _FOLLOWERS + row, 1 + 2 * row
        share_x, share_y = law.shares[row, 0], law.shares[row, 1]
        x, y = rate_x * share_x - rate_y * share_y, rate_x * share_y + rate_y * share_x
        i_real, i_imag = law.factors[row, 0] - x, law.factors[row, 1] - y
        j_real, j_imag = law.factors[row, 2] + x, law.factors[row, 3] + y
        for m in range(runs):
            ex, ey, fx, fy = e[0, first, m], e[1, first, m], e[0, first + 1, m], e[1, first + 1, m]
            gx[k, m] = (i_real * ex - i_imag * ey) + (j_real * fx - j_imag * fy)
            gy[k, m] = (i_real * ey + i_imag * ex) + (j_real * fy + j_imag * fx)
