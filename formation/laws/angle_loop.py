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
from formation.laws.first_follower import BESIDE
from formation.target import TargetFormation

Real = NDArray[np.float64]
Index = NDArray[np.int64]

FIRST_FOLLOWERS = ("stationary", "displacement", "distance", "bearing", "spiral")
"""The laws of :data:`formation.EDGE_LAWS`, by the number that the loops use."""

_LEADER, _FIRST = agents.LEADER, agents.FIRST_FOLLOWER


class Gains(NamedTuple):
    """The law of one formation.

    Attributes:
        triangles: (n - 2, 3) rows: a follower k and its neighbours i and j.
        factors: (n - 2, 4) real and imaginary part of -A_k^T A_i, then of -A_k^T A_j, 1/s.
        first_follower: place in :data:`FIRST_FOLLOWERS`.
    """

    triangles: Index
    factors: Real
    first_follower: int


def gains(law: AngleLaw, target: TargetFormation, first_follower: str) -> Gains:
    """The constants of a law for a target, with its first follower's name."""
    i, j, k = target.graph.triangles.T
    factors = np.ascontiguousarray(law.gains).view(np.float64).reshape(-1, 4)
    return Gains(np.stack([k, i, j], axis=1).astype(np.int64), factors, FIRST_FOLLOWERS.index(first_follower))


def feedback(
    own_x: Real,
    own_y: Real,
    c: Real,
    s: Real,
    other_x: Real,
    other_y: Real,
    law: Gains,
    delta_x: float,
    delta_y: float,
    gx: Real,
    gy: Real,
) -> None:
    """Velocities in body frames, m/s, without v_r.

    Args:
        own_x, own_y: (n, L) where each agent takes itself to be, metres.
        c, s: (n, L) cosine and sine of its heading.
        other_x, other_y: (n, L) where others see it.
        law: constants.
        delta_x, delta_y: displacement that the first follower is told, metres, in the common frame.
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
            dx, dy = own_x[_FIRST, m] - other_x[_LEADER, m], own_y[_FIRST, m] - other_y[_LEADER, m]
            ex, ey = dx * ch + dy * sh, dy * ch - dx * sh
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
    for row in range(len(law.triangles)):
        k, i, j = law.triangles[row, 0], law.triangles[row, 1], law.triangles[row, 2]
        i_real, i_imag = law.factors[row, 0], law.factors[row, 1]
        j_real, j_imag = law.factors[row, 2], law.factors[row, 3]
        for m in range(runs):
            ch, sh = c[k, m], s[k, m]
            dx, dy = other_x[i, m] - own_x[k, m], other_y[i, m] - own_y[k, m]
            ex, ey = dx * ch + dy * sh, dy * ch - dx * sh
            dx, dy = other_x[j, m] - own_x[k, m], other_y[j, m] - own_y[k, m]
            fx, fy = dx * ch + dy * sh, dy * ch - dx * sh
            gx[k, m] = (i_real * ex - i_imag * ey) + (j_real * fx - j_imag * fy)
            gy[k, m] = (i_real * ey + i_imag * ex) + (j_real * fy + j_imag * fx)
