"""How much a cascade amplifies on the way: errors that grow before they decay, disturbances, commands that switch.

The spectrum says nothing of it. An equilateral strip of 48 agents has all rates 0.75 and lets errors grow 161-fold.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.analysis.cascade import Cascade
from formation.analysis.lags import shares
from formation.analysis.noise import bias_response
from formation.plane import Complex, Real
from formation.target import TargetFormation

COARSE = 0.5
"""Seconds between two looks at a norm, over the fastest rate."""

REFINEMENTS = 40
"""Cuts of the interval around the largest of them."""

FREQUENCIES = np.concatenate([[0.0], np.geomspace(0.01, 10.0, 61)])
"""rad/s, over the fastest rate, at which a peak is looked for."""

MOST_STEPS = 20_000


def moving_part(cascade: Cascade) -> Complex:
    """The matrix of the agents that move: all but the leader, and a first follower that stands still."""
    first = agents.FIRST_FOLLOWER if cascade.rates[0] > 0.0 else agents.FIRST_ORDINARY
    return cascade.whole[first:, first:]


def transient_gain(cascade: Cascade) -> tuple[float, float]:
    """The largest norm of e^{Mt} over all t >= 0, and when, seconds: how much all errors together may grow.

    Once the norm is below 1 it never exceeds its largest value before: e^{M(t + s)} = e^{Ms} e^{Mt}.
    """
    size = moving_part(cascade).shape[0]
    h = COARSE / float(cascade.rates.max())
    step = cascade.exponential(h)[-size:, -size:]
    state, best, when = np.eye(size, dtype=np.complex128), 1.0, 0.0
    for index in range(1, MOST_STEPS):
        state = step @ state
        norm = float(np.linalg.norm(state, 2))
        if norm > best:
            best, when = norm, index * h
        if norm < 1.0:
            break
    if when == 0.0:
        return best, when

    def norm_at(t: float) -> float:
        return float(np.linalg.norm(cascade.exponential(t)[-size:, -size:], 2))

    low, high = when - h, when + h
    for _ in range(REFINEMENTS):
        left, right = low + 0.382 * (high - low), low + 0.618 * (high - low)
        low, high = (low, right) if norm_at(left) > norm_at(right) else (left, high)
        if high - low < 1e-3 * h:
            break
    when = 0.5 * (low + high)
    return norm_at(when), when


def overshoot(cascade: Cascade, rate: float, horizon: float = 200.0) -> float:
    """The smallest C in |p~(t)| <= C e^{-rate t} |p~(0)| for all t up to ``horizon`` seconds."""
    size = moving_part(cascade).shape[0]
    h = COARSE / float(cascade.rates.max()) / 10.0
    step = cascade.exponential(h)[-size:, -size:] * np.exp(rate * h)
    state, best = np.eye(size, dtype=np.complex128), 1.0
    for _ in range(round(horizon / h)):
        state = step @ state
        best = max(best, float(np.linalg.norm(state, 2)))
    return best


def peak_gains(cascade: Cascade) -> tuple[float, float]:
    """H-infinity: the largest gain over all frequencies, from errors of all measurements (metres per metre) and from
    velocity disturbances of all agents (seconds) to the errors of all agents."""
    matrix = moving_part(cascade)
    size = len(matrix)
    measured = -matrix @ bias_response(cascade)[-size:]
    measurement = velocity = 0.0
    for omega in FREQUENCIES * cascade.rates.max():
        inverse = np.linalg.inv(1j * omega * np.eye(size) - matrix)
        velocity = max(velocity, float(np.linalg.norm(inverse, 2)))
        measurement = max(measurement, float(np.linalg.norm(inverse @ measured, 2)))
    return measurement, velocity


def dwell_errors(target: TargetFormation, cascade: Cascade, dwell: float, jump: complex) -> Real:
    """(n,) errors, metres, left when delta has switched back and forth by ``jump`` metres every ``dwell`` seconds.

    The error after a switch is y = J - E y, J = z ``jump`` and E = e^{M dwell}; what is left before the next, E y.
    """
    moved = cascade.exponential(dwell)[1:, 1:]
    after = np.linalg.solve(np.eye(cascade.n - 1) + moved, shares(target)[1:] * jump)
    return np.concatenate([[0.0], np.abs(moved @ after)])
