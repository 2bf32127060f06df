"""How far the shape lags behind a reference that repeats: the settled motion of the cascade, harmonic by harmonic.

Relative to the leader and to delta(0), y_k = (p_k - p_1) / delta(0), the loop of eq. (man) on a reference D(t) is

    dy_2/dt = D - y_2 [+ mu y_2],      dy_k/dt = a_k [(1 - w_k) y_i + w_k y_j - y_k] [+ mu f_k (y_j - y_i)],

a_k = sin^2 of the follower angle, the brackets with feed-forward. One agent after the other, the harmonic e^{i m W t}
of what drives it is divided by lambda_m + a_k, with lambda_m = i m W for continuous commands and (e^{i m W T} - 1) / T
for commands that are held over periods T. Where D = e^{i w t} turns at one rate and nobody is told mu, that is

    G_2 = 1 / (1 + i w),      G_k = a_k / (a_k + i w) [(1 - w_k) G_i + w_k G_j].
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.analysis.cascade import Cascade
from formation.laws.feedforward import places, shares
from formation.plane import Complex, Real
from formation.references.protocol import Reference
from formation.target import TargetFormation

SAMPLES = 512
"""Instants of a cycle: its harmonics are exact to rounding where the path is smooth."""


def settled(target: TargetFormation, reference: Reference, feedforward: bool) -> Complex:
    """(S, n) y_k over one cycle, to which a first follower by displacement and all others settle, ideal integrators.

    Args:
        target: the target formation.
        reference: that repeats.
        feedforward: whether agents are told mu.

    Raises:
        ValueError: the reference never repeats.
    """
    t, turning = _cycle(reference)
    return _solve(target, reference, feedforward, turning, np.zeros((len(t), target.graph.n), dtype=np.complex128))


def settled_robots(
    target: TargetFormation, reference: Reference, feedforward: bool, delta: complex, period: float
) -> Complex:
    """(S, n) the same of robots that hold each command for a period, in a body frame that turns meanwhile.

    A robot on its way V_k(t) turns as the way does, so that a held command bends by half the turn of a period,
    V_k (1 + i T/2 Im(V_k' / V_k)), which makes up for most of what holding it loses. To first order in T.

    Args:
        target: the target formation.
        reference: that repeats.
        feedforward: whether agents are told mu.
        delta: delta(0), complex metres.
        period: T, seconds.

    Raises:
        ValueError: the reference never repeats.
    """
    t, turning = _cycle(reference)
    ideal = np.fft.fft(settled(target, reference, feedforward), axis=0)
    way = reference.velocity(t)[:, None] / delta + np.fft.ifft(turning[:, None] * ideal, axis=0)
    bend = np.fft.ifft(turning[:, None] * np.fft.fft(way, axis=0), axis=0)
    size = np.maximum(np.abs(way), np.finfo(np.float64).tiny)
    push = np.asarray(0.5j * period * (bend * np.conj(way) / size).imag * (way / size), dtype=np.complex128)
    held = np.asarray(np.expm1(turning * period) / period, dtype=np.complex128)
    return _solve(target, reference, feedforward, held, push - push[:, :1])


def _cycle(reference: Reference) -> tuple[Real, Complex]:
    """(S,) instants of a cycle, seconds, and what a derivative multiplies each harmonic by."""
    if reference.cycle is None:
        raise ValueError("expected a reference that repeats")
    t: Real = np.linspace(0.0, reference.cycle, SAMPLES, endpoint=False)
    return t, np.asarray(2j * np.pi * np.fft.fftfreq(SAMPLES, reference.cycle / SAMPLES), dtype=np.complex128)


def _solve(target: TargetFormation, reference: Reference, feedforward: bool, shift: Complex, push: Complex) -> Complex:
    """(S, n) y_k, agent after agent, with lambda_m (S,) and a velocity ``push`` (S, n) on top of the law's."""
    t, _ = _cycle(reference)
    rate = reference.rate(t) if feedforward else np.zeros(SAMPLES, dtype=np.complex128)
    loop, share = Cascade.of(target), shares(target)
    y = np.zeros((SAMPLES, target.graph.n), dtype=np.complex128)
    first = agents.FIRST_FOLLOWER
    y[:, first] = _first(shift, rate, reference.factor(t) + push[:, first])
    for row, (i, j) in enumerate(target.graph.neighbours.tolist()):
        k, own, w = row + agents.FIRST_ORDINARY, loop.rates[row + 1], loop.weights[row]
        drive = own * ((1.0 - w) * y[:, i] + w * y[:, j]) + rate * share[row] * (y[:, j] - y[:, i]) + push[:, k]
        y[:, k] = np.fft.ifft(np.fft.fft(drive) / (shift + own))
    return y


def _first(shift: Complex, rate: Complex, factor: Complex) -> Complex:
    """(S,) y_2 of lambda y_2 + y_2 - mu y_2 = D: mu differs from instant to instant, so all harmonics at once."""
    if not rate.any():
        return np.fft.ifft(np.fft.fft(factor) / (shift + 1.0))
    unit = np.eye(len(factor))
    derivative = np.fft.ifft(shift[:, None] * np.fft.fft(unit, axis=0), axis=0)
    return np.asarray(np.linalg.solve(derivative + np.diag(1.0 - rate), factor), dtype=np.complex128)


def shape_residual(target: TargetFormation, points: Complex) -> Real:
    """(...) how far complex points (..., n) are from the target's shape: what no similarity removes, over its size."""
    shape = places(target)
    shape = shape - shape.mean()
    centred = points - points.mean(axis=-1, keepdims=True)
    fitted = (centred @ np.conj(shape) / (np.abs(shape) ** 2).sum())[..., None] * shape
    return np.linalg.norm(centred - fitted, axis=-1) / np.linalg.norm(fitted, axis=-1)
