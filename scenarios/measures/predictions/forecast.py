"""What the theory says of a run before it is made: where each phase leads, how close it gets, and when."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from formation import Phase
from formation.analysis.cascade import Cascade
from formation.analysis.closed_loop import arrival
from formation.analysis.exact import ideal
from formation.plane import Complex, as_complex, as_vectors
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.theory import motion, moves_exactly
from scenarios.measures.tracking import predicted_ends

Real = NDArray[np.float64]

NEAR = 0.01
"""Metres from its place within which an agent counts as arrived in a forecast."""

STEP = 0.05
"""Seconds to which the time of arrival is told."""


@dataclass(frozen=True, eq=False)
class PhaseForecast:
    """One phase of ideal single integrators, exact.

    Attributes:
        end: (n, 2) the end configuration to which the phase converges, metres, at the phase's end.
        points: (n, 2) where the agents are at the phase's end, metres; None where the exact
            solution does not cover the run.
        error_sum: sum of the absolute angle errors there, radians; None likewise.
        arrival: seconds into the phase after which every agent stays within :data:`NEAR` of its place; None likewise,
            if it never does, or where it was not asked for.
    """

    end: Real
    points: Real | None
    error_sum: float | None
    arrival: float | None


def forecast(experiment: Experiment, start: Real, told: Collection[int] | None = None) -> list[PhaseForecast]:
    """The forecast of each phase from a start (n, 2), metres: Theorems 1 and 2 and the closed loop's exact solution.

    The arrival is the dear part: found for the phases with the indices ``told`` alone where these are given.
    """
    here: Real | None = start if moves_exactly(experiment) else None
    forecasts = []
    shaped, loop, first = experiment, None, experiment.first_follower
    for index, (phase, end) in enumerate(zip(experiment.phases, predicted_ends(experiment, start), strict=True)):
        if here is None:
            forecasts.append(PhaseForecast(end, None, None, None))
            continue
        steps = int(np.ceil(phase.duration / (2.0 * STEP)))
        before, shaped = shaped, experiment.of_phase(index)
        if loop is None or shaped is not before:
            loop = Cascade.of(shaped.target, gains=shaped.own_gains)
        arrived = None  # nobody ever does behind a reference that changes; where v_r spreads, it is not asked for
        constant = phase.reference is None and experiment.estimator is None
        if constant and (told is None or index in told):
            arrived = arrival(_errors(loop, as_complex(here), phase, first, as_complex(end)), loop.reach, NEAR, STEP)
        if experiment.estimator is None:
            states = ideal(loop, as_complex(here), phase, first, phase.duration / steps)
            here = as_vectors(next(islice(states, steps, None)))
        else:
            here = motion(experiment, here, index, continuous=True)[-1]
        error_sum = float(np.abs(experiment.angles.errors(here, shaped.target_angles)).sum())
        forecasts.append(PhaseForecast(end, here, error_sum, arrived))
    return forecasts


def _errors(loop: Cascade, start: Complex, phase: Phase, first_follower: str, end: Complex) -> Iterator[Complex]:
    """(n,) differences from the moving end configuration, complex metres, every :data:`STEP` seconds for ever."""
    velocity = complex(*phase.velocity)
    for index, p in enumerate(ideal(loop, start, phase, first_follower, STEP)):
        yield p - (end + velocity * (index * STEP - phase.duration))
