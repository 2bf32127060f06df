"""How a formation follows its maneuver, apart from its shape: scale, orientation and translation, and how fast."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import agents, end_configuration, fit_similarity, pair_ends, wrap
from formation.laws.feedforward import places
from formation.maneuver import pair_places
from formation.plane import as_complex, as_vectors
from scenarios.definition.experiment import Experiment
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]


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
    pairs = pair_ends(start[: agents.FIRST_ORDINARY], experiment.phases, experiment.first_follower, told(experiment))
    return np.stack(
        [
            end_configuration(experiment.of_phase(index).formation, leader, first)
            for index, (leader, first) in enumerate(pairs)
        ]
    )


def reference(experiment: Experiment, trajectory: Trajectory) -> Real:
    """(T, n, 2) the moving end configuration p^ddagger(t) to which each phase converges (Theorem 2), metres."""
    return moving_ends(experiment, trajectory.points[0], trajectory.t, trajectory.phase)


def moving_ends(experiment: Experiment, start: Real, t: Real, phase: NDArray[np.intp]) -> Real:
    """The same from a start (n, 2), metres, at times t (T,), seconds, of the phases with the indices ``phase`` (T,)."""
    if experiment.phases[0].reference is not None:
        return following(experiment, start, t)
    ends = predicted_ends(experiment, start)
    velocity = np.array([each.velocity for each in experiment.phases])
    finish = np.cumsum([each.duration for each in experiment.phases])
    ahead = (finish[phase] - t)[:, None] * velocity[phase]
    return ends[phase] - ahead[:, None, :]


def following(experiment: Experiment, start: Real, t: Real) -> Real:
    """(T, n, 2) where agents from a start (n, 2) are at times t (T,) of the only phase, a reference, without lag."""
    pair = as_complex(start[: agents.FIRST_ORDINARY])
    leader, first = pair_places(
        (pair[0], pair[1]), experiment.phases[0], experiment.first_follower, told(experiment), t
    )
    return placed(experiment, as_vectors(np.stack([leader, first], axis=-1)))


def placed(experiment: Experiment, points: Real) -> Real:
    """(T, n, 2) where agents 1 and 2 put everybody, of points (T, n or 2, 2), metres: z_k on the line from 1 to 2."""
    leader, first = as_complex(points)[:, : agents.FIRST_ORDINARY].T
    return as_vectors(leader[:, None] + places(experiment.formation) * (first - leader)[:, None])


def told(experiment: Experiment) -> bool:
    """Whether agents are told how the formation scales and turns."""
    return experiment.scenario.law.feedforward


def track(experiment: Experiment, trajectory: Trajectory) -> Tracking:
    """The tracking errors of a single run."""
    wanted = reference(experiment, trajectory)
    scale, angle, centroid = fits(experiment, trajectory.phase, trajectory.points)
    scale_0, angle_0, centroid_0 = fits(experiment, trajectory.phase, wanted)
    return Tracking(
        scale=scale / scale_0 - 1.0,
        orientation=wrap(angle - angle_0),
        translation=np.linalg.norm(centroid - centroid_0, axis=-1),
        distances=np.linalg.norm(trajectory.points - wanted, axis=-1),
    )


def fits(experiment: Experiment, phase: NDArray[np.intp], points: Real) -> tuple[Real, Real, Real]:
    """Scale (T,), angle (T,) and centroid (T, 2) of points (T, n, 2) in phases (T,), each of its phase's shape."""
    if not experiment.shapes:
        return fit_similarity(experiment.formation, points)
    parts = [fit_similarity(experiment.of_phase(index).formation, points[phase == index]) for index in np.unique(phase)]
    scale, angle, centroid = (np.concatenate(each) for each in zip(*parts, strict=True))
    return scale, angle, centroid
