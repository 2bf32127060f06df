"""The closed loop of eq. (man) near its end: its matrix, its exact solution, and when every agent has arrived."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from formation.analysis.cascade import DENSE, Cascade
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.target import TargetFormation

FIRST_FOLLOWER_RATE = {"stationary": 0.0, "displacement": 1.0}
"""r_2, 1/s, of the first-follower laws that are linear."""


def closed_loop_matrix(target: TargetFormation, first_follower: str = "stationary") -> Complex:
    """(n - 1, n - 1) the matrix of the error dynamics of agents 2..n, 1/s; see :mod:`formation.analysis.cascade`.

    Raises:
        ValueError: the first follower's law is not linear.
    """
    return linear_cascade(target, first_follower).matrix


def linear_cascade(target: TargetFormation, first_follower: str, gains: Real | None = None) -> Cascade:
    """The cascade of a linear first-follower law.

    Raises:
        ValueError: the first follower's law is not linear.
    """
    if first_follower not in FIRST_FOLLOWER_RATE:
        raise ValueError(f"the closed loop is linear for {', '.join(FIRST_FOLLOWER_RATE)}, got {first_follower!r}")
    return Cascade.of(target, FIRST_FOLLOWER_RATE[first_follower], gains)


def propagate(target: TargetFormation, errors: Real, duration: float, first_follower: str = "stationary") -> Real:
    """Errors (n, 2) of all agents from their moving places after ``duration`` seconds, exact; the leader's is 0."""
    later = linear_cascade(target, first_follower).exponential(duration)[:, 1:] @ as_complex(errors)[1:]
    return as_vectors(later)


def settling_bound(
    target: TargetFormation,
    errors: Real,
    bound: float,
    first_follower: str = "stationary",
    resolution: float = 0.05,
    horizon: float = 600.0,
) -> float | None:
    """The time, seconds, after which every agent stays within ``bound`` metres of its place, to ``resolution`` seconds.

    None if that takes longer than ``horizon``, or never happens.
    """
    return settling_of(linear_cascade(target, first_follower), errors, bound, resolution, horizon)


def settling_of(
    cascade: Cascade, errors: Real, bound: float, resolution: float = 0.05, horizon: float = 600.0
) -> float | None:
    """The same for any cascade."""
    return arrival(_decay(cascade, as_complex(errors), resolution), cascade.reach, bound, resolution, horizon)


def arrival(
    errors: Iterator[Complex], reach: Real, bound: float, resolution: float = 0.05, horizon: float = 600.0
) -> float | None:
    """The time, seconds, after which errors (n,), one state every ``resolution`` seconds, all stay below ``bound``.

    Looks no further once they are in a box of :attr:`Cascade.reach`, ``reach`` (n,), which they never leave.
    """
    last, most = -1, round(horizon / resolution)
    scale = np.maximum(reach, 1.0)
    for k, error in enumerate(islice(errors, most + 1)):
        size = np.abs(error)
        if size.max() >= bound:
            last = k
        elif (size / scale).max() * scale.max() < bound:
            break
    return None if last == most else (last + 1) * resolution


def _decay(cascade: Cascade, errors: Complex, resolution: float) -> Iterator[Complex]:
    """The errors every ``resolution`` seconds: by one matrix, or for many agents by its series, n instead of n^2."""
    step = cascade.exponential(resolution) if cascade.n <= DENSE else None
    while True:
        yield errors
        errors = cascade.act(errors, resolution) if step is None else step @ errors


def asymptotic_rates(target: TargetFormation, first_rate: float = 0.0) -> Real:
    """(n - 2,) rate, 1/s, at which each follower's error decays in the end: the slowest among itself and all upstream.

    Args:
        target: the target formation.
        first_rate: of the first follower, 1/s, from :func:`formation.analysis.first_follower.rate`; 0 if it stands.
    """
    return Cascade.of(target, first_rate).late_rates[1:]
