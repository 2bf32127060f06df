"""What the theory says of a run before it is made: where each phase leads, how close it gets, and when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import agents, propagate, settling_bound
from formation.analysis import closed_loop
from scenarios.definition.experiment import Experiment
from scenarios.measures.tracking import predicted_ends

Real = NDArray[np.float64]

NEAR = 0.01
"""Metres from its place within which an agent counts as arrived in a forecast."""


@dataclass(frozen=True, eq=False)
class PhaseForecast:
    """One phase of ideal single integrators, exact.

    Attributes:
        end: (n, 2) the end configuration to which the phase converges, metres, at the phase's end.
        points: (n, 2) where the agents are at the phase's end, metres; None where the closed loop is not linear.
        error_sum: sum of the absolute angle errors there, radians; None likewise.
        arrival: seconds into the phase after which every agent stays within :data:`NEAR` of its place; None likewise,
            or if it never does.
    """

    end: Real
    points: Real | None
    error_sum: float | None
    arrival: float | None


def forecast(experiment: Experiment, start: Real) -> list[PhaseForecast]:
    """The forecast of each phase from a start (n, 2), metres: Theorems 1 and 2 and the closed loop's exact solution."""
    linear = (
        experiment.scenario.law.name == "angle"
        and experiment.first_follower in closed_loop.FIRST_FOLLOWER_RATE
        and experiment.scenario.law.activation == "simultaneous"
        and experiment.estimator is None
    )
    points: Real | None = start if linear else None
    forecasts = []
    for phase, end in zip(experiment.phases, predicted_ends(experiment, start), strict=True):
        if points is None:
            forecasts.append(PhaseForecast(end, None, None, None))
            continue
        errors = points - (end - np.array(phase.velocity) * phase.duration)
        errors[agents.LEADER] = 0.0  # exact by definition; what is left is rounding
        arrival = settling_bound(experiment.target, errors, NEAR, experiment.first_follower)
        points = end + propagate(experiment.target, errors, phase.duration, experiment.first_follower)
        error_sum = float(np.abs(experiment.angles.errors(points, experiment.target_angles)).sum())
        forecasts.append(PhaseForecast(end, points, error_sum, arrival))
    return forecasts
