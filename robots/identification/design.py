"""The linear model of a log: what the poses would be by the numbers that are sought, one column each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import Log
from robots.identification.odometry import Complex, Odometry, chords, filled, odometry, reference

Real = NDArray[np.float64]

COLUMNS = ("wheel_radius", "per_turned", "offset_ahead", "offset_left", "lag", "drift", "marker_angle")
"""What the columns after the poses' own belong to: per_turned is r / b, drift the heading's per radian of wheels."""


@dataclass(frozen=True, eq=False)
class Design:
    """A log made linear about a guess.

    Attributes:
        way: the odometry at the guessed lag.
        columns: (T, 3, 1 + len(COLUMNS)) the poses' x, y, theta beyond the guess's own, and their regressors.
        step: (T, 2) the way of each turn, metres: where the heading slips, it turns.
        speed: (T, 3) the poses' change per turn: what a deviation of the lag does.
        driven: (T,) metres driven on the way to each turn.
        turned: (T,) radians turned on the way to each turn.
    """

    way: Odometry
    columns: Real
    step: Real
    speed: Real
    driven: Real
    turned: Real


def linearised(log: Log, lag: float, radius: float, per_turned: float) -> Design:
    """The design about a guess of the lag, turns, the wheel radius, metres, and r / b.

    The true heading turns the way of each turn: with the chord c_k at the reference heading phi_k, to first order

        x_k - x_{k-1} = r c_k + i r_0 c_k (theta_k - phi_k),    theta_k = (r / b) turned_k + drift forward_k + slip_k.
    """
    poses = filled(log.poses)
    theta = poses[:, 2]
    way = odometry(log, lag)
    heading = reference(way, theta, per_turned)
    chord = chords(way, heading)
    step = radius * chord

    def turning(angle: Real) -> Real:
        """(T, 3) what a heading that deviates by ``angle`` does to the poses."""
        middle = np.concatenate([angle[:1], (angle[1:] + angle[:-1]) / 2.0])
        return _pose(np.cumsum(1j * step * middle), angle)

    observed = poses - poses[0]
    observed[:, :2] += turning(heading - theta[0])[:, :2]
    nothing = np.zeros(log.turns)
    lever = np.exp(1j * theta) - np.exp(1j * theta[0])
    path = _pose(np.cumsum(step), per_turned * way.turned)
    speed = np.gradient(path, axis=0)
    columns = (
        observed,
        _pose(np.cumsum(chord), nothing),
        turning(way.turned),
        _pose(lever, nothing),
        _pose(1j * lever, nothing),
        speed,
        turning(way.forward),
        _pose(nothing.astype(complex), np.ones(log.turns)),
    )
    return Design(
        way,
        np.ascontiguousarray(np.stack(columns, axis=2)),
        _plane(step),
        speed,
        radius * np.abs(np.diff(way.forward, prepend=0.0)),
        per_turned * np.abs(np.diff(way.turned, prepend=0.0)),
    )


def _plane(z: Complex) -> Real:
    return np.ascontiguousarray(z)[:, None].view(np.float64)


def _pose(z: Complex, angle: Real) -> Real:
    return np.column_stack([z.real, z.imag, angle])
