"""What can be said against a run before it is made: robots that do not fit, followers that cannot settle in time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from formation import decay_rates
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.course import too_fast
from scenarios.measures.predictions.misfits import misfits, start_misfits, too_wide
from scenarios.measures.predictions.way import in_the_way

LEAST_EXPONENT = 1.0
"""Rate times duration below which a follower cannot settle: its distance has not even shrunk by the factor e."""

MOST_NAMED = 5
"""Followers that are named one by one."""


def remarks(experiment: Experiment, seed: int) -> list[str]:
    """One sentence for each thing that speaks against the run with that seed; `show`, `run` and `export` print them."""
    points, headings = experiment.starts.draw(np.random.default_rng(seed))
    told = [*start_misfits(experiment, points, headings), *misfits(experiment, points)]
    met = [] if told else in_the_way(experiment, points)  # a way to where nobody fits is no other matter
    return [
        *(f"does not fit: {misfit}" for misfit in told),
        *(f"too wide: {wide}" for wide in too_wide(experiment)),
        *(f"in the way: {thing}" for thing in met),
        *(f"too slow: {slow}" for slow in _slow(experiment)),
        *(f"too fast: {fast}" for fast in too_fast(experiment, points)),
    ]


def _slow(experiment: Experiment) -> Iterator[str]:
    """Followers whose own rate, sin^2 of the follower angle (Theorem 1), leaves them no time in the whole run."""
    if experiment.scenario.law.name != "angle":
        return
    gains = 1.0 if experiment.own_gains is None else experiment.own_gains
    rates, seconds = decay_rates(experiment.target) * gains, sum(phase.duration for phase in experiment.phases)
    exponents = rates * seconds
    slow = np.flatnonzero(exponents < LEAST_EXPONENT)
    slow = slow[np.argsort(rates[slow], kind="stable")]
    for row in slow[:MOST_NAMED]:
        i, j, k = experiment.numbered(experiment.target.graph.triangles[row])
        yield (
            f"agent {k} closes in at {rates[row]:.2g} 1/s, sin^2 of the angle at which it sees {i} and {j}: in "
            f"{seconds:g} s its distance shrinks to {np.exp(-exponents[row]):.3g} of what it was, it cannot settle "
            "within the run"
        )
    if len(slow) > MOST_NAMED:
        yield f"{len(slow) - MOST_NAMED} more agents cannot settle within the run"
