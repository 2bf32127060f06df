"""What sensor errors become: the covariance of noise that is new each period, and the offset of a constant bias.

With commands held over a period T, F = I + T M, and B the coefficients r_k (1 - w_k), r_k w_k of the measurements,

    X = F X F^H + T^2 B P B^H      covariance of the errors p~, P the mean square of each measurement's noise
    -M^{-1} B b                    where constant errors b of the measurements leave the agents

A follower of two settled neighbours has E|p~|^2 = a T (|1 - w|^2 P_ki + |w|^2 P_kj) / (2 - a T).
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.analysis.cascade import Cascade
from formation.plane import Complex, Real, as_complex


def noise_power(cascade: Cascade, positions: Real, position_noise: float, bearing_noise: float = 0.0) -> Real:
    """(2n - 3,) mean square error, m^2, of each measured relative position, in the order of :attr:`SensingGraph.edges`.

    Args:
        cascade: the loop.
        positions: (n, 2) where the agents are, metres.
        position_noise: standard deviation of each coordinate, metres.
        bearing_noise: standard deviation of a rotation about the observer, radians.
    """
    observer, observed = cascade.graph.edges.T
    length = np.abs(as_complex(positions[observed] - positions[observer]))
    return 2.0 * position_noise**2 + 2.0 * length**2 * (1.0 - np.exp(-(bearing_noise**2) / 2.0))


@np.errstate(divide="ignore", invalid="ignore")  # at the longest period what does not decay has no bound
def covariance(cascade: Cascade, period: float, power: Real) -> Complex:
    """(n, n) E[p~ p~^H], m^2, in the steady state of commands held over ``period`` seconds.

    Agents of one depth at a time, so that a thousand agents take a second; exact.

    Args:
        cascade: the loop; a first follower with r_2 = 0 stands still.
        period: T, seconds; below :func:`formation.analysis.margins.longest_period`.
        power: (2n - 3,) mean square error of each measurement, m^2.
    """
    n, neighbours = cascade.n, cascade.graph.neighbours
    rates = np.concatenate([[0.0], cascade.rates])
    keep = 1.0 - period * rates
    pull = np.zeros((n, 2), dtype=np.complex128)
    pull[agents.FIRST_ORDINARY :] = period * cascade.rates[1:, None] * cascade.pulls
    pair = np.zeros((n, 2), dtype=np.intp)
    pair[agents.FIRST_ORDINARY :] = neighbours
    push = np.zeros(n)
    push[agents.FIRST_FOLLOWER] = (period * cascade.rates[0]) ** 2 * power[0]
    push[agents.FIRST_ORDINARY :] = (np.abs(pull[agents.FIRST_ORDINARY :]) ** 2 * power[1:].reshape(-1, 2)).sum(axis=1)
    moving = np.flatnonzero(rates > 0.0)
    levels = [moving[cascade.graph.depth[moving] == depth] for depth in range(1, int(cascade.graph.depth.max()) + 1)]
    x = np.zeros((n, n), dtype=np.complex128)
    for place, rows in enumerate(levels):
        i, j = pair[rows].T
        pull_i, pull_j = pull[rows].T
        for columns in levels[: place + 1]:
            m, o = pair[columns].T
            pull_m, pull_o = np.conj(pull[columns].T)
            upstream = pull_i[:, None] * x[i] + pull_j[:, None] * x[j]  # rows of F x but for the diagonal's share
            both = upstream[:, columns] * keep[columns] + upstream[:, m] * pull_m + upstream[:, o] * pull_o
            own = x[np.ix_(rows, m)] * pull_m + x[np.ix_(rows, o)] * pull_o
            right = both + keep[rows, None] * own
            right[rows[:, None] == columns] += push[rows[np.isin(rows, columns)]]
            block = right / (1.0 - np.outer(keep[rows], keep[columns]))
            x[np.ix_(rows, columns)] = block
            x[np.ix_(columns, rows)] = np.conj(block).T
    return x


def noise_rms(cascade: Cascade, period: float, power: Real) -> Real:
    """(n,) root mean square distance of each agent from its place, metres; arguments as for :func:`covariance`.

    At the longest period itself, an agent whose errors no longer decay, and all that follow it, are infinitely far off.
    """
    square = np.diagonal(covariance(cascade, period, power)).real
    return np.sqrt(np.where(np.isnan(square), np.inf, np.maximum(square, 0.0)))


def bias_response(cascade: Cascade) -> Complex:
    """(n, 2n - 3) where a constant error of one metre of each measurement leaves each agent, metres."""
    edges = len(cascade.graph.edges)
    response = np.zeros((cascade.n, edges), dtype=np.complex128)
    response[agents.FIRST_FOLLOWER, 0] = float(cascade.rates[0] > 0.0)
    for k, ((i, j), pull) in enumerate(zip(cascade.graph.neighbours.tolist(), cascade.pulls, strict=True)):
        row = k + agents.FIRST_ORDINARY
        response[row] = pull[0] * response[i] + pull[1] * response[j]
        response[row, 1 + 2 * k : 3 + 2 * k] += pull
    return response


def bias_gains(cascade: Cascade) -> Real:
    """(n,) the norm of each agent's :func:`bias_response`: metres of offset per metre of independent biases."""
    return np.linalg.norm(bias_response(cascade), axis=1)


def disturbance_bounds(cascade: Cascade, size: float) -> Real:
    """(n,) how far a velocity disturbance of at most ``size`` m/s at every agent pushes each from its place, metres."""
    bounds = [0.0, size / float(cascade.rates[0]) if cascade.rates[0] > 0.0 else 0.0]
    own = (size / cascade.rates[1:]).tolist()
    for (i, j), (a, b), share in zip(
        cascade.graph.neighbours.tolist(), np.abs(cascade.pulls).tolist(), own, strict=True
    ):
        bounds.append(share + a * bounds[i] + b * bounds[j])
    return np.array(bounds)
