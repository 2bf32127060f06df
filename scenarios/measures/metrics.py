"""What a run achieved: angle errors, settling, separation, the testbed's verdict, distance to the predicted end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from robots.model import COLLISION_CENTRE
from robots.testbed import Separation, Verdict, collision_centres, judge, separation
from scenarios.definition.experiment import Experiment
from scenarios.measures.clearance import Clearance, clearance, standing_at
from scenarios.measures.late_rates import measured_late_rates
from scenarios.measures.tracking import Tracking, predicted_ends, track
from scenarios.measures.window import WINDOW, Window, trailing
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Outcome = Literal["converged", "not_converged", "rejected", "diverged"]
"""``rejected``: converged, by a goal that asks for the testbed's acceptance too, which refused."""


@dataclass(frozen=True, eq=False)
class PhaseEnd:
    """The state at the end of one phase.

    Attributes:
        name: of the phase.
        row: of the trajectory.
        angle_errors, axle_angle_errors: (m,) radians, of projected points and of axle centres.
        predicted: (n, 2) end configuration of the projected points that the theory predicts, metres.
        distances: (n,) from the predicted to the measured points, metres.
    """

    name: str
    row: int
    angle_errors: Real
    axle_angle_errors: Real
    predicted: Real
    distances: Real


@dataclass(frozen=True, eq=False)
class Metrics:
    """The measures of one run.

    Attributes:
        angle_errors: (T, m) of the projected points, radians.
        error_sum: (T,) their absolute sum, the paper's ||e_1||.
        axle_error_sum: (T,) the same of the axle centres.
        window: the errors over a trailing window; None where sensors are free of noise.
        judged: (T,) what the goal bounds: ``error_sum``, or the absolute sum of the window's means.
        settling_time: seconds after which ``judged`` stays below the goal; None if it does not.
        separation: of the collision centres.
        clearance: from walls and obstacles; None on a floor with neither.
        tracking: of scale, orientation and translation.
        late_rates: of the followers' distances, 1/s, as measured; None where there is too little to fit.
        phases: the state at the end of each phase that the run completed.
    """

    angle_errors: Real
    error_sum: Real
    axle_error_sum: Real
    window: Window | None
    judged: Real
    settling_time: float | None
    separation: Separation
    clearance: Clearance | None
    verdict: Verdict
    tracking: Tracking
    late_rates: list[float | None]
    phases: tuple[PhaseEnd, ...]
    outcome: Outcome


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def measure(experiment: Experiment, trajectory: Trajectory) -> Metrics:
    """The measures of a single run."""
    angles, targets = experiment.angles, experiment.targets(trajectory.phase)
    errors = angles.errors(trajectory.points, targets)
    axle_errors = angles.errors(trajectory.poses[..., :2], targets)
    error_sum = np.abs(errors).sum(axis=-1)
    axle_sum = np.abs(axle_errors).sum(axis=-1)
    tracking = track(experiment, trajectory)
    near = separation(checked(experiment, trajectory))
    window = trailing(trajectory.t, errors) if experiment.noisy else None
    judged = error_sum if window is None else np.abs(window.mean).sum(axis=-1)
    verdict = judge(
        trajectory.t,
        trajectory.poses,
        trajectory.wheel_speeds,
        experiment.arena,
        experiment.fleet.drive,
        near,
        standing_at(experiment, trajectory.t),
    )
    return Metrics(
        angle_errors=errors,
        error_sum=error_sum,
        axle_error_sum=axle_sum,
        window=window,
        judged=judged,
        settling_time=settling_time(trajectory.t, judged, experiment.goal),
        separation=near,
        clearance=clearance(experiment, trajectory),
        verdict=verdict,
        tracking=tracking,
        late_rates=measured_late_rates(experiment, trajectory),
        phases=_phase_ends(experiment, trajectory, errors, axle_errors, tracking),
        outcome=_outcome(experiment, judged, verdict, tracking, trajectory),
    )


def ahead_as_checked(experiment: Experiment) -> bool:
    """Whether the testbed checks the very points that the law steers: robots whose l is the testbed's."""
    ahead = np.all(experiment.fleet.nid.projection_distance == COLLISION_CENTRE)
    return experiment.plant != "single_integrator" and bool(ahead)


def checked(experiment: Experiment, trajectory: Trajectory) -> Real:
    """(T, n, 2) the points that the testbed checks for collisions, metres."""
    return trajectory.points if ahead_as_checked(experiment) else collision_centres(trajectory.poses)


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def judged_end(experiment: Experiment, trajectory: Trajectory) -> Real:
    """(...) what the goal bounds at the end of a run, or of each run of a batch, radians."""
    first = np.searchsorted(trajectory.t, trajectory.t[-1] - WINDOW) if experiment.noisy else -1
    last = trajectory.between(int(first), len(trajectory.t))
    errors = experiment.angles.errors(last.points, experiment.of_phase(last.phase[-1]).target_angles)
    return np.abs(trailing(last.t, errors).mean[-1]).sum(axis=-1)


def settling_time(t: Real, error_sum: Real, bound: float) -> float | None:
    """The first of the times t (T,) from which ``error_sum`` (T,) stays below ``bound``; None if it ends above."""
    above = np.flatnonzero(~(error_sum < bound))
    if not above.size:
        return float(t[0])
    if above[-1] == len(t) - 1:
        return None
    return float(t[above[-1] + 1])


def _phase_ends(
    experiment: Experiment, trajectory: Trajectory, errors: Real, axle_errors: Real, tracking: Tracking
) -> tuple[PhaseEnd, ...]:
    ends = []
    finished = np.isfinite(trajectory.points[-1]).all()
    predictions = predicted_ends(experiment, trajectory.points[0])
    for index, (phase, predicted) in enumerate(zip(experiment.phases, predictions, strict=True)):
        rows = np.flatnonzero(trajectory.phase == index)
        if not rows.size or (rows[-1] == len(trajectory.t) - 1 and not finished):
            break
        row = int(rows[-1])
        ends.append(PhaseEnd(phase.name, row, errors[row], axle_errors[row], predicted, tracking.distances[row]))
    return tuple(ends)


def _outcome(
    experiment: Experiment, judged: Real, verdict: Verdict, tracking: Tracking, trajectory: Trajectory
) -> Outcome:
    if not np.isfinite(trajectory.poses[-1]).all():
        return "diverged"
    if not judged[-1] < experiment.goal or not _stayed(tracking.distances, experiment.scenario.goal.distance_m):
        return "not_converged"
    return "rejected" if experiment.scenario.goal.accepted and not verdict.accepted else "converged"


def _stayed(distances: Real, bound: float | None) -> bool:
    """Whether distances (T, n) from the predicted places, once all below a bound, stay so to the end."""
    if bound is None:
        return True
    within: NDArray[np.bool_] = np.all(distances < bound, axis=1)
    return bool(within.any() and within[int(within.argmax()) :].all())
