"""From a log to a robot's numbers with intervals.

Generalised least squares gives what the poses depend on linearly, maximum likelihood the noises that weigh it; both are
made anew about a better guess of the lag until it stands still. The base length is fitted to the heading over the whole
log: see :func:`_base_length`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.design import COLUMNS, Design, linearised
from robots.identification.likelihood import LOGARITHMIC, Likelihood, Whitened
from robots.identification.log import Log, LogError
from robots.identification.numbers import QUANTILE_95, Interval, RobotNumbers, normal, share
from robots.identification.odometry import filled, odometry
from robots.model import GTERNAL

Real = NDArray[np.float64]

_START = np.array([*np.log([3e-4, 1e-3, 3e-3, 1e-2, 2e-2, 0.3]), np.arctanh(0.5)])
_ROUNDS = 5  # guesses of the lag
_STILL = 0.05  # of its deviation: a lag that moves by less stands still
_GRADIENT = 0.05  # of the likelihood, at which a fit is done: a hundredth of a deviation
_LAGS = np.arange(-3.0, 3.01, 0.25)
_LINEARISED = (
    0.025  # relative deviation allowed to slips for what the linear model leaves out where a robot accelerates:
)
# without it their intervals hold the truth in 92 to 93.5 of 100 synthetic logs
_BLURRED, _SHARPEST = 1.5, 1e-6  # half widths of a logarithm's interval between which it is believed
_LARGEST_NOISE = 2.0  # of a logarithm; no noise of a robot is larger
_WINDOW = 5  # turns over which the first guess of the lag compares ways


@dataclass(frozen=True, eq=False)
class Identified:
    """What a log says about its robot.

    Attributes:
        log: the log.
        intervals: by the names of :class:`robots.identification.numbers.RobotNumbers`.
        short_base_length: metres, as :attr:`RobotNumbers.base_length` but from what the heading does within a few
            turns, with the drift below taken out.
        drift: radians per metre that the heading drifts to the left, as of unequal wheels.
        residuals: (T, 3) of x, y, theta, whitened; NaN where a turn says nothing.
    """

    log: Log
    intervals: dict[str, Interval]
    short_base_length: Interval
    drift: Interval
    residuals: Real

    @property
    def numbers(self) -> RobotNumbers:
        return RobotNumbers(**{name: interval.value for name, interval in self.intervals.items()})


def identify(log: Log) -> Identified:
    """The numbers of the robot that a log is of.

    Raises:
        LogError: the log does not hold what tells them: the robot hardly drives, or hardly turns.
    """
    lag = first_lag(log)
    radius, per_turned = GTERNAL.drive.wheel_radius, GTERNAL.drive.wheel_radius / GTERNAL.drive.base_length
    noises = _START
    for _ in range(_ROUNDS):
        design = linearised(log, lag, radius, per_turned)
        _check_way(design)
        likelihood = Likelihood(design, log.heading_quantum)
        noises = _most_likely(likelihood, noises)
        white = likelihood.whitened(noises)
        covariance: Real = np.linalg.inv(white.information).astype(np.float64)
        radius, per_turned = float(white.linear[0]), float(white.linear[1])
        change = float(white.linear[4])
        lag += change
        if abs(change) < _STILL * np.sqrt(covariance[4, 4]):
            break
    intervals = _noise_intervals(noises, likelihood)
    intervals |= _linear_intervals(white, covariance, lag)
    intervals["base_length"] = _base_length(design, noises, radius, float(np.sqrt(covariance[0, 0])))
    moving = log.moving
    intervals["missing"] = share(int((moving & ~log.heard).sum()), int(moving.sum()))
    intervals["stale"] = share(int((~log.seen[1:]).sum()), log.turns - 1)
    slope = np.array([1.0 / per_turned, -radius / per_turned**2])
    short = normal(radius / per_turned, float(np.sqrt(slope @ covariance[:2, :2] @ slope)))
    drift = normal(float(white.linear[5]) / radius, float(np.sqrt(covariance[5, 5])) / radius)
    residuals = np.full((log.turns, 3), np.nan)
    rows = np.flatnonzero(design.way.known)[1:]
    residuals[rows] = white.residuals.reshape(-1, 3)
    ordered = {name: intervals[name] for name in RobotNumbers.__dataclass_fields__}
    return Identified(log, ordered, short, drift, residuals)


def first_lag(log: Log) -> float:
    """The lag, in quarters of a turn, at which the ways of wheels and cameras over a few turns agree best."""
    poses = filled(log.poses)
    misfits: list[float] = []
    for lag in _LAGS.tolist():
        way = odometry(log, lag)
        rows = way.heard
        turned, seen = _over(way.turned[rows]), _over(poses[rows, 2])
        driven, moved = np.abs(_over(way.forward[rows])), np.hypot(*_over(poses[rows, :2]).T)
        misfits.append(_unexplained(turned, seen) + _unexplained(driven, moved))
    return float(_LAGS[int(np.argmin(misfits))])


def _over(values: Real) -> Real:
    return values[_WINDOW:] - values[:-_WINDOW]


def _unexplained(cause: Real, effect: Real) -> float:
    """The share of the effect's square that a multiple of the cause leaves."""
    norm = float(np.linalg.norm(cause) * np.linalg.norm(effect))
    return 1.0 - (float(cause @ effect) / norm) ** 2 if norm > 0.0 else 1.0


def _check_way(design: Design) -> None:
    driven, turned = float(design.driven.sum()), float(design.turned.sum())
    if driven < 0.5 or turned < 3.0:
        raise LogError(f"the robot drives {driven:.2f} m and turns {turned:.1f} rad, expected at least 0.5 m and 3 rad")


def _most_likely(likelihood: Likelihood, start: Real) -> Real:
    from scipy.optimize import minimize

    options = {"gtol": _GRADIENT, "maxiter": 60, "initial_trust_radius": 1.0, "max_trust_radius": 4.0}
    found = minimize(
        likelihood.value,
        start,
        jac=likelihood.slope,
        hess=likelihood.curvature,
        method="trust-exact",
        options=options,
    )
    return np.asarray(found.x)


def _noise_intervals(noises: Real, likelihood: Likelihood) -> dict[str, Interval]:
    """Normal in the noises' logarithms; from 0 up where the log does not tell a noise from none."""
    allowed = np.array([_LINEARISED if name.startswith("slip") else 0.0 for name in LOGARITHMIC] + [0.0])
    half = QUANTILE_95 * np.hypot(likelihood.deviations(noises), allowed)
    found = {}
    for i, name in enumerate(LOGARITHMIC):
        value, width = float(noises[i]), float(half[i])
        if _SHARPEST < width < _BLURRED:
            found[name] = Interval(*np.exp([value, value - width, value + width]).tolist())
        else:
            found[name] = Interval(float(np.exp(value)), 0.0, _upper_end(noises, i, likelihood))
    ends = np.tanh([noises[-1], noises[-1] - half[-1], noises[-1] + half[-1]])
    return found | {"jitter_memory": Interval(*ends.tolist())}


def _upper_end(noises: Real, i: int, likelihood: Likelihood) -> float:
    """Where the likelihood, all other noises as they are, has fallen as far as at the end of a 95 % interval."""
    from scipy.optimize import brentq

    least = likelihood.value(noises) + QUANTILE_95**2 / 2.0

    def beyond(logarithm: float) -> float:
        moved = np.array(noises)
        moved[i] = logarithm
        return likelihood.value(moved) - least

    return float(np.exp(brentq(beyond, float(noises[i]), _LARGEST_NOISE, xtol=1e-3)))


def _linear_intervals(white: Whitened, covariance: Real, lag: float) -> dict[str, Interval]:
    value = dict(zip(COLUMNS, white.linear.tolist(), strict=True))
    deviation = dict(zip(COLUMNS, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    # The cameras' heading carries the offset: turned by the marker's angle it is that in the robot's frame.
    offset = complex(value["offset_ahead"], value["offset_left"]) * complex(np.exp(1j * value["marker_angle"]))
    return {
        "wheel_radius": normal(value["wheel_radius"], deviation["wheel_radius"]),
        "offset_ahead": normal(offset.real, deviation["offset_ahead"]),
        "offset_left": normal(offset.imag, deviation["offset_left"]),
        "marker_angle": normal(value["marker_angle"], deviation["marker_angle"]),
        "lag": normal(lag, deviation["lag"]),
    }


def _base_length(design: Design, noises: Real, radius: float, radius_deviation: float) -> Interval:
    """The base length by which the encoders' difference gives the heading over the whole log, by plain least squares.

    It trusts no model of the slip, so a drift or a memory of it shows in no short window. Its deviation is that of its
    weights on slip, jitter and noise as they were found.
    """
    rows = design.way.known
    turned, heading = design.way.turned[rows], design.columns[rows, 2, 0]
    centred = turned - turned.mean()
    weights = np.zeros(len(rows))
    weights[rows] = centred / (centred @ centred)
    slope = float(weights[rows] @ heading)
    _, noise, _, drifting, turning, jitter = np.exp(2.0 * noises[:-1]).tolist()
    ahead = np.cumsum(weights[::-1])[::-1]  # a slip moves all headings after it
    variance = float(ahead**2 @ (drifting * design.driven + turning * design.turned)) + noise * float(weights @ weights)
    memory, carried = float(np.tanh(noises[-1])), 0.0
    for weight in (weights * design.speed[:, 2])[::-1].tolist():
        variance += jitter * weight * (weight + 2.0 * memory * carried)
        carried = weight + memory * carried
    base = radius / slope
    return normal(base, base * float(np.hypot(np.sqrt(variance) / slope, radius_deviation / radius)))
