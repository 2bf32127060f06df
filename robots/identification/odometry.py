"""From encoder counts to what the cameras should have seen.

The counts that belong to the pose of turn k are read ``lag`` turns later. With the wheel angles phi_l, phi_r of those
counts, the heading is theta_k = theta_0 + (r / b) (phi_r - phi_l), and a turn carries the axle along the chord of an
arc as long as r (phi_l + phi_r) / 2 grows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import Log
from robots.model import ENCODER_COUNTS_PER_TURN

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Flags = NDArray[np.bool_]

RADIANS_PER_COUNT = 2.0 * np.pi / ENCODER_COUNTS_PER_TURN

_AROUND = 10  # turns on either side whose mean holds the encoders' heading to the cameras'


@dataclass(frozen=True, eq=False)
class Odometry:
    """The wheels' way at the times of the poses.

    Attributes:
        known: (T,) turns with a new pose and with counts on both sides of its time, none lost between.
        heard: (T,) turns with a new pose and with counts at all: those of lost messages are spread between.
        forward: (T,) mean angle of both wheels since turn 0, radians.
        turned: (T,) phi_r - phi_l since turn 0, radians.
    """

    known: Flags
    heard: Flags
    forward: Real
    turned: Real


def odometry(log: Log, lag: float) -> Odometry:
    """The wheels' angles at the times of the poses, when the counts come ``lag`` turns later.

    Between two readings the wheels move smoothly and never back: monotone cubic interpolation.
    """
    from scipy.interpolate import PchipInterpolator

    at = np.flatnonzero(log.heard)
    when = np.arange(log.turns) + lag
    inside = np.clip(when, at[0], at[-1])
    left, right = (RADIANS_PER_COUNT * PchipInterpolator(at, log.counts[at, side])(inside) for side in (0, 1))
    after = np.clip(np.searchsorted(at, when), 1, len(at) - 1)
    whole = (at[after] - at[after - 1] == 1) | ~log.moving
    heard = log.seen & (when == inside)
    forward, turned = (left + right) / 2.0, right - left
    return Odometry(heard & whole, heard, forward - forward[0], turned - turned[0])


def filled(poses: Real) -> Real:
    """Poses (T, 3) with those of turns that have none put in between their neighbours."""
    turns, good = np.arange(len(poses)), np.isfinite(poses[:, 0])
    return np.stack([np.interp(turns, turns[good], poses[good, i]) for i in range(3)], axis=-1)


def reference(way: Odometry, theta: Real, per_turned: float) -> Real:
    """(T,) the encoders' heading, held to the cameras' theta (T,) by the mean difference of the turns around.

    A camera's jitter does not bend it, and it does not drift off. ``per_turned`` is r / b.
    """
    heading = per_turned * way.turned
    window = np.ones(2 * _AROUND + 1)
    share = np.convolve(np.ones(len(theta)), window, "same")
    return heading + np.convolve(theta - heading, window, "same") / share


def chords(way: Odometry, heading: Real) -> Complex:
    """(T,) the axle's way to each turn per metre of wheel radius, at headings (T,), as x + i y."""
    turn = np.diff(heading)
    step = np.diff(way.forward) * np.sinc(turn / (2.0 * np.pi)) * np.exp(0.5j * (heading[1:] + heading[:-1]))
    return np.concatenate([[0.0], step])
