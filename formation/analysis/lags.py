"""How far a formation lags behind commands that change: what eq. (man) leaves when delta or v_r does not stand still.

The first follower is steered by displacement (r_2 = 1). z_k = (p*_k - p*_1) / (p*_2 - p*_1) is where follower k belongs
relative to the leader, in units of delta. All of it is exact, once transients have decayed.

    delta(t) = delta_0 + delta' t:   q_2 = -delta' / r_2,  q_k = (1 - w_k) q_i + w_k q_j - z_k delta' / r_k
    delta(t) = delta e^{i omega t}:  G_2 = r_2 / (r_2 + i omega),  G_k = r_k / (r_k + i omega) [(1 - w_k) G_i + w_k G_j]
    v_r(t) = v_0 + v_r' t, spread with the gain kappa:  L_k = 1 / kappa + mean of the L of those that k hears, seconds,
                                     q_k = (1 - w_k) q_i + w_k q_j - L_k v_r' / r_k,  q_2 = -L_2 v_r' / r_2

q are errors from the places that the command of the same instant gives, p_k - p_1 = G_k delta(t) where it turns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from formation import agents
from formation.analysis.cascade import Cascade
from formation.plane import Complex, Real, as_complex
from formation.target import TargetFormation


def shares(target: TargetFormation) -> Complex:
    """(n,) z_k of each agent: 0 for the leader, 1 for the first follower."""
    p = as_complex(target.positions)
    return (p - p[agents.LEADER]) / (p[agents.FIRST_FOLLOWER] - p[agents.LEADER])


def ramp_lags(target: TargetFormation, slope: complex, first_rate: float = 1.0) -> Complex:
    """(n,) errors, complex metres, while delta moves at ``slope`` m/s."""
    loop = Cascade.of(target, first_rate)
    return _settled(loop, np.asarray(-shares(target) * slope))


def turning_gains(target: TargetFormation, omega: float, first_rate: float = 1.0) -> Complex:
    """(n,) G_k: p_k - p_1 = G_k delta(t) while delta turns at ``omega`` rad/s; :func:`shares` where it stands still."""
    loop = Cascade.of(target, first_rate)
    filters = loop.rates / (loop.rates + 1j * omega)
    gains = [0j, complex(filters[0])]
    for (i, j), (a, b), own in zip(loop.graph.neighbours.tolist(), loop.pulls, filters[1:], strict=True):
        gains.append(complex(own * (a * gains[i] + b * gains[j])))
    return np.array(gains)


def velocity_lags(
    target: TargetFormation, edges: ArrayLike, gain: float, slope: complex, first_rate: float = 1.0
) -> Complex:
    """(n,) errors, complex metres, while v_r changes at ``slope`` m/s^2 and only the leader knows it.

    Args:
        target: the target formation.
        edges: (m, 2) rows (receiver, sender) of the communication graph.
        gain: kappa of the consensus, 1/s.
        slope: v_r', m/s^2, complex.
        first_rate: r_2, 1/s.
    """
    delays = estimate_delays(target.graph.n, edges, gain)
    return _settled(Cascade.of(target, first_rate), np.asarray(-delays * slope))


def estimate_delays(n: int, edges: ArrayLike, gain: float) -> Real:
    """(n,) L_k, seconds by which each agent's estimate of a ramping v_r lags; 0 for the leader."""
    hears = np.zeros((n, n))
    e = np.asarray(edges, dtype=np.intp).reshape(-1, 2)
    hears[e[:, 0], e[:, 1]] = 1.0
    hears[agents.LEADER] = 0.0
    mean = hears / np.maximum(hears.sum(axis=1, keepdims=True), 1.0)
    own = np.full(n, 1.0 / gain)
    own[agents.LEADER] = 0.0
    return np.linalg.solve(np.eye(n) - mean, own)


def _settled(loop: Cascade, pushes: Complex) -> Complex:
    """(n,) where constant pushes (n,), m/s, leave the errors: M q + pushes = 0."""
    q = np.zeros(loop.n, dtype=np.complex128)
    q[1:] = np.linalg.solve(loop.matrix, -pushes[1:])
    return q
