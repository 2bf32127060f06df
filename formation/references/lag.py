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


def cycle(reference: Reference) -> Real:
    """(S,) the instants of a cycle at which the settled motion is known, seconds.

    Raises:
        ValueError: the reference never repeats.
    """
    if reference.cycle is None:
        raise ValueError("expected a reference that repeats")
    return np.linspace(0.0, reference.cycle, SAMPLES, endpoint=False)


class Settled:
    """The settled motion of ideal integrators on a reference, or of robots that hold each command for a period.

    A robot on its way V_k(t) turns as the way does, so that a held command bends by half the turn of a period,
    V_k (1 + i T/2 Im(V_k' / V_k)), which makes up for most of what holding it loses. To first order in T.
    """

    def __init__(
        self,
        target: TargetFormation,
        reference: Reference,
        feedforward: bool,
        gains: Real | None = None,
        held: tuple[complex, float] | None = None,
    ) -> None:
        """Prepare.

        Args:
            target: the target formation, its first follower steered by displacement.
            reference: that repeats.
            feedforward: whether agents are told mu.
            gains: (n - 2,) of the followers, on top of eq. (u); None where all are 1.
            held: delta(0), complex metres, and T, seconds; None for ideal integrators.

        Raises:
            ValueError: the reference never repeats.
        """
        t = cycle(reference)
        self._turning = np.asarray(2j * np.pi * np.fft.fftfreq(SAMPLES, t[1]), dtype=np.complex128)
        self._loop, self._share = Cascade.of(target, gains=gains), shares(target)
        self._factor = reference.factor(t)
        self._rate = reference.rate(t) if feedforward else np.zeros(SAMPLES, dtype=np.complex128)
        self._shift, self._push = self._turning, np.zeros((SAMPLES, target.graph.n), dtype=np.complex128)
        self._first: Complex | None = None
        if held is not None:
            delta, period = held
            self._push = _bend(self._derivative(self()) + reference.velocity(t)[:, None] / delta, self._turning, period)
            self._shift = np.asarray(np.expm1(self._turning * period) / period, dtype=np.complex128)
            self._first = self._inverse() if self._rate.any() else None

    def __call__(self, pushed: Complex | None = None) -> Complex:
        """(S, n) y_k over one cycle; with velocities ``pushed`` (S, n), in units of delta(0), on top of the law's."""
        push = self._push if pushed is None else self._push + pushed
        push = push - push[:, :1]
        y = np.zeros_like(push)
        first, loop = agents.FIRST_FOLLOWER, self._loop
        y[:, first] = self._first_follower(push[:, first])
        for row, (i, j) in enumerate(loop.graph.neighbours.tolist()):
            k, own, w = row + agents.FIRST_ORDINARY, loop.rates[row + 1], loop.weights[row]
            drive = own * ((1.0 - w) * y[:, i] + w * y[:, j]) + push[:, k]
            drive = drive + self._rate * self._share[row] * (y[:, j] - y[:, i])
            y[:, k] = np.fft.ifft(np.fft.fft(drive) / (self._shift + own))
        return y

    def _derivative(self, y: Complex) -> Complex:
        return np.fft.ifft(self._turning[:, None] * np.fft.fft(y, axis=0), axis=0)

    def _first_follower(self, push: Complex) -> Complex:
        """(S,) y_2 of lambda y_2 + y_2 - mu y_2 = D: mu differs from instant to instant, so all harmonics at once."""
        if self._first is not None:
            return self._first @ (self._factor + push)
        if self._rate.any():  # of ideal integrators, D itself
            return self._factor
        return np.fft.ifft(np.fft.fft(self._factor + push) / (self._shift + 1.0))

    def _inverse(self) -> Complex:
        """(S, S) from what drives the first follower to y_2."""
        derivative = np.fft.ifft(self._shift[:, None] * np.fft.fft(np.eye(SAMPLES), axis=0), axis=0)
        return np.asarray(np.linalg.inv(derivative + np.diag(1.0 - self._rate)), dtype=np.complex128)


def _bend(way: Complex, turning: Complex, period: float) -> Complex:
    """(S, n) what a held command loses and the robot's turn makes up for, of ways (S, n)."""
    bend = np.fft.ifft(turning[:, None] * np.fft.fft(way, axis=0), axis=0)
    size = np.maximum(np.abs(way), np.finfo(np.float64).tiny)
    return np.asarray(0.5j * period * (bend * np.conj(way) / size).imag * (way / size), dtype=np.complex128)


def shape_residual(target: TargetFormation, points: Complex) -> Real:
    """(...) how far complex points (..., n) are from the target's shape: what no similarity removes, over its size."""
    shape = places(target)
    shape = shape - shape.mean()
    centred = points - points.mean(axis=-1, keepdims=True)
    fitted = (centred @ np.conj(shape) / (np.abs(shape) ** 2).sum())[..., None] * shape
    return np.linalg.norm(centred - fitted, axis=-1) / np.linalg.norm(fitted, axis=-1)
