"""What a row of a sweep holds, found while the runs go on: no trajectory is kept, however long and many they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.model import COLLISION_CENTRE
from robots.testbed import COLLISION_DISTANCE, OBSTACLE_DISTANCE, collision_centres, fastest_allowed
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import Outcome, ahead_as_checked
from scenarios.simulation.compiled.runs import Chunk
from scenarios.simulation.schedule import schedule, times

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

DOUBT = 1e-12
"""Radians for each angle: far beyond the rounding of an error, and never met by chance."""


@dataclass(frozen=True)
class Achieved:
    """What a run achieved; numbers and words as in :class:`scenarios.measures.metrics.Metrics`."""

    outcome: Outcome
    error_sum: float
    axle_error_sum: float
    settling_time: float | None
    separation: float
    accepted: bool
    violations: tuple[str, ...]


def watchable(experiment: Experiment) -> bool:
    """Whether a watch finds all that the row of a run holds: of equal robots with perfect sensors on an open floor."""
    arena, equal = experiment.arena, np.ndim(experiment.fleet.drive.wheel_speed_limit) == 0
    bounded = experiment.scenario.goal.distance_m is not None
    return equal and not (experiment.noisy or experiment.events or arena.walls or arena.obstacles or bounded)


class Watch:
    """Looks at states of runs (FIELDS, n, L) as they pass, and knows in the end what each run achieved.

    Args:
        experiment: one whose sensors are free of noise.
        state: of all runs, at their start when the watch begins; it is the one that advances.
    """

    def __init__(self, experiment: Experiment, state: Real) -> None:
        from scenarios.measures.online.watching import Angles, Ground, Seen, room

        runs = state.shape[2]
        targets = experiment.target_angles
        self._experiment = experiment
        self._as_checked = ahead_as_checked(experiment)
        self._t, _ = times(experiment)
        self._angles = Angles(
            experiment.angles.triples.astype(np.int64),
            np.cos(targets),
            np.sin(targets),
            float(experiment.goal),
            DOUBT * len(targets),
        )
        self._ground = Ground(np.array([*experiment.arena.x, *experiment.arena.y]), _way(experiment))
        doubtful, off_floor, self._on_obstacle = np.zeros((3, runs), dtype=bool)
        self._seen = Seen(np.full(runs, -1, dtype=np.int64), doubtful, np.full(runs, np.inf), off_floor, np.zeros(runs))
        self._state, self._room = state, room(runs)
        self.take(Chunk(0, 0, state[None], np.empty((0, *state.shape[1:], 0), dtype=np.int32)))

    def take(self, chunk: Chunk) -> None:
        """Look at the states of a chunk."""
        from scenarios.measures.online.watching import look

        rows, experiment = chunk.rows, self._experiment
        centres = rows if self._as_checked else self._centred(rows)
        look(rows, centres, chunk.first, self._angles, self._ground, self._seen, self._room)
        if experiment.arena.obstacles:
            from robots.worlds.lanes import PX, PY

            points = np.ascontiguousarray(centres[:, PX : PY + 1].transpose(0, 3, 2, 1))
            near = np.min([obstacle.distance(points) for obstacle in experiment.arena.obstacles], axis=0)
            self._on_obstacle |= (near <= OBSTACLE_DISTANCE).any(axis=(0, 2))

    def _centred(self, rows: Real) -> Real:
        """The states with the points that the testbed checks in the place of the projected ones."""
        from robots.worlds.lanes import PX, PY, THETA, X

        poses = np.ascontiguousarray(rows[:, X : THETA + 1].transpose(0, 3, 2, 1))
        centred = rows.copy()
        centred[:, PX : PY + 1] = collision_centres(poses).transpose(0, 3, 2, 1)
        return centred

    def achieved(self) -> list[Achieved | None]:
        """What each run achieved; None where its states do not tell, or are not finite: its trajectory has to."""
        from robots.worlds.lanes import PX, X

        whole = np.isfinite(self._state[: PX + 2]).all(axis=(0, 1)) & ~self._seen.doubtful
        errors, axle_errors = self._error_sums(PX), self._error_sums(X)
        return [self._of(m, float(errors[m]), float(axle_errors[m])) if whole[m] else None for m in range(len(whole))]

    def _error_sums(self, x: int) -> Real:
        """(L,) of the states as they are, at the points whose x is a field: those of trajectories, bit for bit."""
        places = np.ascontiguousarray(self._state[x : x + 2].T)
        errors = self._experiment.angles.errors(places, self._experiment.target_angles)
        sums: Real = np.abs(errors).sum(axis=-1)
        return sums

    def _of(self, m: int, error_sum: float, axle_error_sum: float) -> Achieved:
        experiment, last, least = self._experiment, int(self._seen.last_above[m]), float(self._seen.least[m])
        kinds = {
            "floor": self._seen.off_floor[m],
            "collision": least <= COLLISION_DISTANCE,
            "obstacle": self._on_obstacle[m],
            "actuator": self._seen.fastest[m] > fastest_allowed(experiment.robot.drive),
        }
        violations = tuple(kind for kind, holds in kinds.items() if holds)
        accepted = not any(kind != "actuator" for kind in violations)
        outcome: Outcome = "converged"
        if last == len(self._t) - 1:
            outcome = "not_converged"
        elif experiment.scenario.goal.accepted and not accepted:
            outcome = "rejected"
        settled = None if last == len(self._t) - 1 else float(self._t[last + 1])
        return Achieved(outcome, error_sum, axle_error_sum, settled, least, accepted, violations)


def _way(experiment: Experiment) -> float:
    """Metres that axle, projected point and the point that the testbed checks go in a period, for each rad/s.

    A point a ahead of the axle goes at most |v| + a |omega|, and with v = r (w_r + w_l) / 2, omega = r (w_r - w_l) / b
    that is r max(1, 2 a / b) max(|w_l|, |w_r|) at most.
    """
    drive, ahead = experiment.robot.drive, max(float(experiment.nid.projection_distance), COLLISION_CENTRE)
    period = max(part.period for part in schedule(experiment))
    return float(drive.wheel_radius * max(1.0, 2.0 * ahead / drive.base_length) * period)
