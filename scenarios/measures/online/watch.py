"""What a row of a sweep holds, found while the runs go on: no trajectory is kept, however long and many they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.model import COLLISION_CENTRE
from robots.testbed import COLLISION_DISTANCE, OBSTACLE_DISTANCE, collision_centres, fastest_allowed
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import Outcome
from scenarios.simulation.compiled.runs import Chunk
from scenarios.simulation.schedule import times

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


class Watch:
    """Looks at states of runs (FIELDS, n, L) as they pass, and knows in the end what each run achieved.

    Args:
        experiment: one whose sensors are free of noise.
        state: of all runs, at their start when the watch begins; it is the one that advances.
    """

    def __init__(self, experiment: Experiment, state: Real) -> None:
        from scenarios.measures.online.watching import Angles

        runs = state.shape[2]
        targets = experiment.target_angles
        self._experiment = experiment
        self._t = times(experiment)
        self._angles = Angles(
            experiment.angles.triples.astype(np.int64),
            np.cos(targets),
            np.sin(targets),
            float(experiment.goal),
            DOUBT * len(targets),
        )
        self._last_above = np.full(runs, -1, dtype=np.int64)
        self._least = np.full(runs, np.inf)
        self._doubtful, self._off_floor, self._fast, self._on_obstacle = np.zeros((4, runs), dtype=bool)
        self._floor = np.array([*experiment.arena.x, *experiment.arena.y])
        self._state = state
        self.take(Chunk(0, 0, state[None], np.empty((0, *state.shape[1:], 0), dtype=np.int32)))

    def take(self, chunk: Chunk) -> None:
        """Look at the states of a chunk."""
        from scenarios.measures.online import watching

        rows, experiment = chunk.rows, self._experiment
        watching.last_above(rows, chunk.first, self._angles, self._last_above, self._doubtful)
        watching.beyond_floor(rows, self._floor, self._off_floor)
        watching.beyond_wheels(rows, float(fastest_allowed(experiment.robot.drive)), self._fast)
        centres = rows if _ahead_as_checked(experiment) else self._centred(rows)
        watching.nearest(centres, self._least)
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
        from robots.worlds.lanes import PX, PY, THETA, X

        state = self._state
        poses = np.ascontiguousarray(state[X : THETA + 1].T)
        points = np.ascontiguousarray(state[PX : PY + 1].T)
        whole = np.isfinite(poses.sum(axis=(1, 2))) & ~self._doubtful
        return [
            self._of(m, self._error_sum(points[m]), self._error_sum(poses[m, :, :2])) if whole[m] else None
            for m in range(state.shape[2])
        ]

    def _error_sum(self, places: Real) -> float:
        """Of one run: numpy rounds an angle by its place among others, and a row is to come from its seed alone."""
        errors = self._experiment.angles.errors(np.ascontiguousarray(places), self._experiment.target_angles)
        return float(np.abs(errors).sum())

    def _of(self, m: int, error_sum: float, axle_error_sum: float) -> Achieved:
        experiment, last, least = self._experiment, int(self._last_above[m]), float(self._least[m])
        kinds = {
            "floor": self._off_floor[m],
            "collision": least <= COLLISION_DISTANCE,
            "obstacle": self._on_obstacle[m],
            "actuator": self._fast[m],
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


def _ahead_as_checked(experiment: Experiment) -> bool:
    """Whether the testbed checks the very points that the law steers: robots whose l is the testbed's."""
    return experiment.plant != "single_integrator" and experiment.nid.projection_distance == COLLISION_CENTRE
