"""Dead reckoning: how far off a robot is that follows its encoders alone for a while, by a given set of numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import Log
from robots.identification.odometry import RADIANS_PER_COUNT, filled, odometry

Real = NDArray[np.float64]

WINDOW = 50
"""Turns of the testbed's loop, 3.3 s."""


@dataclass(frozen=True)
class Reckoning:
    """Errors at the end of a window, one window beginning at every turn.

    Attributes:
        position: root mean square, metres.
        heading: root mean square, radians.
        windows: how many.
    """

    position: float
    heading: float
    windows: int


def dead_reckoning(
    log: Log,
    wheel_radius: float,
    base_length: float,
    lag: float = 0.0,
    offset: complex = 0.0,
    marker_angle: float = 0.0,
    spread: bool = True,
    window: int = WINDOW,
) -> Reckoning:
    """The errors of a set of numbers on a log.

    Args:
        log: the log.
        wheel_radius: metres.
        base_length: metres.
        lag: turns by which counts come later than the pose that belongs to them; whole where ``spread`` is False.
        offset: of the tracked point, ahead + i left, metres.
        marker_angle: of the tracked heading beyond the direction of motion, radians.
        spread: whether counts of lost messages are spread over the turns that lack them; else the last ones stand.
        window: turns.
    """
    poses = filled(log.poses)
    if spread:
        way = odometry(log, lag)
        usable, forward, turned = way.heard, wheel_radius * way.forward, wheel_radius / base_length * way.turned
    else:
        rows = np.arange(log.turns) + round(lag)
        usable = log.seen & (rows >= 0) & (rows < log.turns)
        counts = filled(np.column_stack([log.counts, log.counts[:, :1]]))[:, :2]
        angles = RADIANS_PER_COUNT * counts[np.clip(rows, 0, log.turns - 1)]
        forward = wheel_radius * angles.mean(axis=1)
        turned = wheel_radius / base_length * (angles[:, 1] - angles[:, 0])
    heading = turned - turned[0]
    turn = np.diff(heading)
    step = np.diff(forward) * np.sinc(turn / (2.0 * np.pi)) * np.exp(0.5j * (heading[1:] + heading[:-1]))
    path = np.concatenate([[0.0], np.cumsum(step)])

    theta = poses[:, 2] - marker_angle
    axle = poses[:, 0] + 1j * poses[:, 1] - offset * np.exp(1j * theta)
    begin = np.arange(log.turns - window)
    begin = begin[usable[begin] & usable[begin + window]]
    end = begin + window
    off = theta[end] - theta[begin] - (heading[end] - heading[begin])
    moved = (path[end] - path[begin]) * np.exp(1j * (theta[begin] - heading[begin]))
    away = np.abs(axle[end] - axle[begin] - moved)
    return Reckoning(float(np.sqrt((away**2).mean())), float(np.sqrt((off**2).mean())), len(begin))
