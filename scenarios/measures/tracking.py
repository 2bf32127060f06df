"""How a formation follows its maneuver, apart from its shape: scale, orientation and translation, and how fast."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import agents, asymptotic_rates, end_configuration, fit_similarity, pair_ends, wrap
from scenarios.definition.experiment import Experiment
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

FIT_NEAR, FIT_FAR = 1e-7, 2e-2
"""Metres between which a distance is taken to decay with its late rate: below the far transient, above rounding."""

FIT_ROWS = 20
"""Fewest recorded states that a rate is fitted to."""


@dataclass(frozen=True, eq=False)
class Tracking:
    """Errors of the whole formation against the moving end configuration that the theory predicts.

    Attributes:
        scale: (T,) c / c_predicted - 1.
        orientation: (T,) theta - theta_predicted in (-pi, pi], radians.
        translation: (T,) distance of the centroid from its predicted place, metres.
        distances: (T, n) of each projected point from its predicted place, metres.
    """

    scale: Real
    orientation: Real
    translation: Real
    distances: Real


def predicted_ends(experiment: Experiment, start: Real) -> Real:
    """(P, n, 2) the end configuration of each phase that the theory predicts from a start (n, 2), metres."""
    pairs = pair_ends(start[: agents.FIRST_ORDINARY], experiment.phases, experiment.first_follower)
    return np.stack([end_configuration(experiment.formation, leader, first) for leader, first in pairs])


def reference(experiment: Experiment, trajectory: Trajectory) -> Real:
    """(T, n, 2) the moving end configuration p^ddagger(t) to which each phase converges (Theorem 2), metres."""
    return moving_ends(experiment, trajectory.points[0], trajectory.t, trajectory.phase)


def moving_ends(experiment: Experiment, start: Real, t: Real, phase: NDArray[np.intp]) -> Real:
    """The same from a start (n, 2), metres, at times t (T,), seconds, of the phases with the indices ``phase`` (T,)."""
    ends = predicted_ends(experiment, start)
    velocity = np.array([each.velocity for each in experiment.phases])
    finish = np.cumsum([each.duration for each in experiment.phases])
    ahead = (finish[phase] - t)[:, None] * velocity[phase]
    return ends[phase] - ahead[:, None, :]


def track(experiment: Experiment, trajectory: Trajectory) -> Tracking:
    """The tracking errors of a single run."""
    wanted = reference(experiment, trajectory)
    scale, angle, centroid = fit_similarity(experiment.formation, trajectory.points)
    scale_0, angle_0, centroid_0 = fit_similarity(experiment.formation, wanted)
    return Tracking(
        scale=scale / scale_0 - 1.0,
        orientation=wrap(angle - angle_0),
        translation=np.linalg.norm(centroid - centroid_0, axis=-1),
        distances=np.linalg.norm(trajectory.points - wanted, axis=-1),
    )


def predicted_late_rates(experiment: Experiment) -> Real | None:
    """(n - 2,) the rate, 1/s, at which each follower's distance decays in the end; None but for the angle law.

    The slowest of the follower itself, of all that it depends on, and of a first follower steered by displacement.
    """
    if experiment.scenario.law.name != "angle":
        return None
    rates = asymptotic_rates(experiment.target)
    return np.minimum(rates, 1.0) if experiment.first_follower == "displacement" else rates


def measured_late_rates(experiment: Experiment, trajectory: Trajectory) -> list[float | None]:
    """The late decay rate, 1/s, of each follower's distance from where agents 1 and 2 put it, in the last phase.

    Agents 1 and 2 count where they are, not where they should be: contact may have moved them. None where too few
    states lie between :data:`FIT_NEAR` and :data:`FIT_FAR`.
    """
    last = trajectory.phase == trajectory.phase[-1]
    points, t = trajectory.points[last], trajectory.t[last]
    leader, first = points[-1, : agents.FIRST_ORDINARY]
    if (leader == first).all() or not np.isfinite(points).all():
        return [None] * (experiment.n - agents.FIRST_ORDINARY)
    velocity = np.array(experiment.phases[trajectory.phase[-1]].velocity)
    places = end_configuration(experiment.formation, leader, first) - ((t[-1] - t)[:, None] * velocity)[:, None, :]
    distances = np.linalg.norm(points - places, axis=-1)[:, agents.FIRST_ORDINARY :]
    return [_late_rate(t, distance) for distance in distances.T]


def _late_rate(t: Real, distance: Real) -> float | None:
    far = np.flatnonzero(distance > FIT_FAR)
    begin = far[-1] + 1 if far.size else 0
    near = np.flatnonzero(distance[begin:] < FIT_NEAR)
    end = begin + near[0] if near.size else len(t)
    if end - begin < FIT_ROWS:
        return None
    slope = np.polyfit(t[begin:end] - t[begin], np.log(distance[begin:end]), 1)[0]
    return float(-slope)
