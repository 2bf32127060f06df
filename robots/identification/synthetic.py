"""Logs of robots with known numbers: to prove the identification, and to put a simulated robot beside a real one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import Log
from robots.identification.numbers import TURN, RobotNumbers
from robots.identification.odometry import RADIANS_PER_COUNT

Real = NDArray[np.float64]

FINE = 20
"""Steps per turn in which a robot moves: the jitter of its poses is resolved to a twentieth of a turn."""

_MARGIN = 5  # turns before and after the log, for lag and jitter
_HEADING_QUANTUM = 0.001  # rad, as in the log of a real robot


@dataclass(frozen=True, eq=False)
class Way:
    """What the wheels do, in fine steps from :data:`_MARGIN` turns before the log to as many after it.

    Attributes:
        forward: (S,) metres per step, as the wheels roll.
        turn: (S,) radians per step, likewise.
    """

    forward: Real
    turn: Real


def random_way(rng: np.random.Generator, turns: int) -> Way:
    """Straights, spins, arcs and rests of one to five seconds, begun and ended as a drive of 0.2 s does it."""
    from scipy.signal import lfilter

    steps = (turns + 2 * _MARGIN) * FINE
    forward, turn = np.zeros(steps), np.zeros(steps)
    begin = 0
    while begin < steps:
        end = begin + int(rng.uniform(15.0, 80.0) * FINE)
        kind = rng.choice(4, p=(0.35, 0.3, 0.3, 0.05))
        speed = rng.choice((-1.0, 1.0), p=(0.3, 0.7)) * rng.uniform(0.03, 0.15)
        spin = rng.choice((-1.0, 1.0)) * rng.uniform(0.5, 3.0)
        forward[begin:end], turn[begin:end] = ((speed, 0.0), (0.0, spin), (speed, 0.35 * spin), (0.0, 0.0))[kind]
        begin = end
    share = 1.0 - np.exp(-1.0 / (3.0 * FINE))
    for _ in range(2):
        forward, turn = (lfilter([share], [1.0, share - 1.0], command) for command in (forward, turn))
    return Way(forward * TURN / FINE, turn * TURN / FINE)


def way_of(log: Log, numbers: RobotNumbers) -> Way:
    """The way that the wheels of a log went, for a robot of those numbers to go it again."""
    from scipy.interpolate import PchipInterpolator

    at = np.flatnonzero(log.heard)
    steps = np.arange(-_MARGIN * FINE, (log.turns + _MARGIN) * FINE + 1) / FINE
    read = np.clip(steps + numbers.lag, at[0], at[-1])
    left, right = (
        numbers.wheel_radius * RADIANS_PER_COUNT * np.diff(PchipInterpolator(at, log.counts[at, side])(read))
        for side in (0, 1)
    )
    return Way((left + right) / 2.0, (right - left) / numbers.base_length)


def synthesise(way: Way, truth: RobotNumbers, rng: np.random.Generator) -> tuple[Real, Real]:
    """Raw poses (T, 3), headings wrapped and rounded, and counts (T, 2) of a robot that goes a way."""
    steps = len(way.forward)
    turns = steps // FINE - 2 * _MARGIN
    driven, turned = np.abs(way.forward), np.abs(way.turn)
    slip = np.sqrt(truth.slip_heading**2 * driven + truth.slip_turning**2 * turned) * rng.standard_normal(steps)
    turn = way.turn + slip
    theta = np.cumsum(turn)
    z = np.cumsum(
        way.forward * np.exp(1j * (theta - turn / 2.0))
        + truth.slip_along * np.sqrt(driven) * (rng.standard_normal((steps, 2)) @ (1.0, 1j))
    )
    side = way.turn * truth.base_length / 2.0
    wheels = np.cumsum(np.stack([way.forward - side, way.forward + side], axis=1), axis=0) / truth.wheel_radius

    at = np.arange(turns) + _timing(truth, turns, rng)
    rows = np.clip(np.rint((at + _MARGIN) * FINE).astype(int) - 1, 0, steps - 1)
    tracked = z[rows] + (truth.offset_ahead + 1j * truth.offset_left) * np.exp(1j * theta[rows])
    noise = truth.position_noise * rng.standard_normal((turns, 2))
    heading = theta[rows] + truth.marker_angle + truth.heading_noise * rng.standard_normal(turns)
    heading = np.rint(np.angle(np.exp(1j * heading)) / _HEADING_QUANTUM) * _HEADING_QUANTUM
    poses = np.column_stack([tracked.real + noise[:, 0], tracked.imag + noise[:, 1], heading])

    when = (np.arange(1, steps + 1) / FINE) - _MARGIN
    read = np.arange(turns) - truth.lag
    counts = np.floor(np.stack([np.interp(read, when, wheels[:, i]) for i in (0, 1)], axis=1) / RADIANS_PER_COUNT)
    return _repeated(poses, truth.stale, rng), _repeated(counts, truth.missing, rng)


def _timing(truth: RobotNumbers, turns: int, rng: np.random.Generator) -> Real:
    from scipy.signal import lfilter

    memory = truth.jitter_memory
    noise = rng.standard_normal(turns)
    noise[1:] *= np.sqrt(1.0 - memory**2)
    return np.asarray(truth.jitter * lfilter([1.0], [1.0, -memory], noise))


def _repeated(values: Real, share: float, rng: np.random.Generator) -> Real:
    """Rows of which a share is lost: the row before stands in its place."""
    kept = rng.random(len(values)) >= share
    kept[0] = True
    return values[np.maximum.accumulate(np.where(kept, np.arange(len(values)), 0))]


def random_truth(rng: np.random.Generator) -> RobotNumbers:
    """Numbers as a real robot may have them, all noises on."""
    return RobotNumbers(
        wheel_radius=0.016 * rng.uniform(0.98, 1.02),
        base_length=rng.uniform(0.103, 0.111),
        offset_ahead=rng.uniform(-0.003, 0.003),
        offset_left=rng.uniform(-0.003, 0.003),
        marker_angle=rng.uniform(-0.02, 0.02),
        lag=rng.uniform(0.1, 1.5),
        jitter=rng.uniform(0.15, 0.4),
        jitter_memory=rng.uniform(0.2, 0.7),
        position_noise=rng.uniform(0.05e-3, 0.5e-3),
        heading_noise=rng.uniform(0.5e-3, 2e-3),
        slip_along=rng.uniform(1e-3, 4e-3),
        slip_heading=rng.uniform(5e-3, 2e-2),
        slip_turning=rng.uniform(1e-2, 3e-2),
        missing=rng.uniform(0.05, 0.3),
        stale=rng.uniform(0.002, 0.02),
    )
