"""When a run does what: its phases, cut where something happens or a reference bends, in whole control periods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from formation import Phase
from scenarios.definition.events.event import SAME_TIME
from scenarios.definition.experiment import Experiment


@dataclass(frozen=True)
class Part:
    """A stretch of a run in which nothing begins, ends or bends but at its begin.

    Attributes:
        index: of its phase.
        begins: whether the phase begins with it.
        start: seconds since the start of the run.
        duration: seconds.
        count: control periods.
    """

    index: int
    begins: bool
    start: float
    duration: float
    count: int

    @property
    def period(self) -> float:
        """Length of its control periods, seconds."""
        return self.duration / self.count


def schedule(experiment: Experiment) -> list[Part]:
    """The parts of a run in their order; those of a run without events and bends are its phases."""
    length = experiment.scenario.plant.control_period_s
    times = {time for event in experiment.events for time in event.boundaries}
    parts, start = [], 0.0
    for index, phase in enumerate(experiment.phases):
        for low, high in _cuts(phase, [t - start for t in sorted(times)]):
            count, _ = split(high - low, length)
            parts.append(Part(index, low == 0.0, start + low, high - low, count))
        start += phase.duration
    return parts


def _cuts(phase: Phase, times: list[float]) -> Iterator[tuple[float, float]]:
    """The stretches of a phase between its bends and these times, seconds since its begin."""
    inside = [t for t in sorted([*times, *phase.bends]) if SAME_TIME < t < phase.duration - SAME_TIME]
    edges = [0.0]
    for edge in [*inside, phase.duration]:
        if edge - edges[-1] > SAME_TIME or edge is phase.duration:
            edges.append(edge)
    return pairwise(edges)


def split(duration: float, control_period: float) -> tuple[int, float]:
    """How many control periods fill so many seconds, and their length, seconds, stretched so that they fit exactly."""
    count = max(1, round(duration / control_period))
    return count, duration / count


def periods(phase: Phase, control_period: float) -> tuple[int, float]:
    """How many control periods fit a phase that nothing cuts, and their length, seconds."""
    return split(phase.duration, control_period)


def pieces(phase: Phase, control_period: float) -> list[tuple[int, float]]:
    """The same of each stretch between the bends of a phase that no event cuts."""
    return [split(high - low, control_period) for low, high in _cuts(phase, [])]


def count_periods(experiment: Experiment) -> int:
    """How many control periods a run has."""
    return sum(part.count for part in schedule(experiment))


def times(experiment: Experiment) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """(T,) when each control period of a run ends, seconds, its start before them; and the phase (T,) of each."""
    ends, phases = [np.zeros(1)], [np.zeros(1, dtype=np.intp)]
    for part in schedule(experiment):
        ends.append(part.start + part.duration * (np.arange(1, part.count + 1) / part.count))
        phases.append(np.full(part.count, part.index, dtype=np.intp))
    return np.concatenate(ends), np.concatenate(phases)
