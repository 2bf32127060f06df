"""The safety filter of a run, with the sensors' noise in what it sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.own_motion import Sensed
from robots.safety import Distributed, Noise, SafetyFilter, make_filter
from robots.safety.protocol import BLOCKERS
from scenarios.definition.experiment import Experiment

Real = NDArray[np.float64]


class Guard:
    """Filters the velocities of a run, or of a batch of runs, once per control period.

    The law and the filter share one sensor: what a follower measures of a neighbour enters both with the same noise.

    Attributes:
        filter: the filter itself, with what it says about the last period.
    """

    def __init__(self, experiment: Experiment, safety: SafetyFilter) -> None:
        table = experiment.scenario.sensor
        self.filter = safety
        self._distributed = safety if isinstance(safety, Distributed) else None
        self._position, self._bearing = table.position_noise_m, float(np.radians(table.bearing_noise_deg))
        self._noise: Noise | None = None
        self._period = experiment.scenario.plant.control_period_s

    def begin_period(self, keys: NDArray[np.uint64] | None, period: float) -> None:
        """Take the keys (...) of the noise that holds for one control period, seconds; None for perfect sensors."""
        self._period = period
        self._noise = None if keys is None else Noise(keys, self._position, self._bearing)

    def __call__(self, sensed: Sensed, feedback: Real, common: Real) -> Real:
        """The filtered velocities; see :meth:`robots.safety.SafetyFilter.filter`.

        A robot that filters for itself knows where it is now; a filter that works for all has what it is told.
        """
        where, frames, period, noise = sensed.others, sensed.headings, self._period, self._noise
        if self._distributed is not None:
            return self._distributed.filter(sensed.own, frames, feedback, common, period, noise, where)
        return self.filter.filter(where, frames, feedback, common, period, noise)


class SafetyRecord:
    """What the filter said, period by period: arrays as in :class:`scenarios.simulation.trajectory.Trajectory`.

    Without a filter nothing was changed, relaxed or stuck.
    """

    def __init__(self, rows: int, shape: tuple[int, ...], guard: Guard | None) -> None:
        self._filter = None if guard is None else guard.filter
        self.intervention = np.zeros((rows, *shape))
        self.relaxation = np.zeros((rows, *shape))
        self.blockers: NDArray[np.int32] = np.full((rows, *shape, BLOCKERS), -1, dtype=np.int32)
        self.stuck = np.zeros((rows, *shape))

    def take(self, row: int) -> None:
        """Record the last period."""
        if self._filter is not None:
            self.intervention[row] = self._filter.intervention
            self.relaxation[row] = self._filter.relaxation
            self.blockers[row] = self._filter.blockers
            self.stuck[row] = self._filter.stuck


def make_guard(experiment: Experiment, batch: tuple[int, ...]) -> Guard | None:
    """The guard of a run; None without a filter."""
    safety = make_filter(
        experiment.safety,
        (*batch, experiment.n),
        experiment.fleet.drive,
        experiment.fleet.nid,
        experiment.filter_settings,
        experiment.arena,
    )
    return None if safety is None else Guard(experiment, safety)
