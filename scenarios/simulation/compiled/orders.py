"""What agents are told in each control period, as arrays for the compiled period: the same for all runs, told once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.simulation.schedule import Part, count_periods, schedule
from scenarios.simulation.told import runge_kutta_steps, told

if TYPE_CHECKING:
    from scenarios.simulation.compiled.period import Commands

Real = NDArray[np.float64]

BLOCK = 256
"""Control periods whose commands are found at once."""

KEPT = 100_000
"""Vectors of v_r up to which the commands of a whole run are kept for the next run: found in a tenth of a second."""


@dataclass(frozen=True, eq=False)
class Orders:
    """The commands of some control periods of one phase.

    Attributes:
        phase: its index.
        count: of periods.
        commands: of all of them.
    """

    phase: int
    count: int
    commands: Commands

    def between(self, first: int, end: int) -> Commands:
        """Those of the periods from ``first`` up to, not including, ``end``."""
        all_ = self.commands
        return all_._replace(**{name: getattr(all_, name)[first:end] for name in ("velocity", "delta", "rate")})


def orders(experiment: Experiment) -> Iterator[Orders]:
    """The commands of a run, period by period: v_r as the leader has it, or as each agent has it by consensus."""
    each = len(_instants(experiment)) * (1 if experiment.estimator is None else experiment.n)
    return _found(experiment) if count_periods(experiment) * each > KEPT else iter(_kept(experiment))


@lru_cache(maxsize=1)
def _kept(experiment: Experiment) -> tuple[Orders, ...]:
    return tuple(_found(experiment))


def _found(experiment: Experiment) -> Iterator[Orders]:
    instants = _instants(experiment)
    estimates = None if experiment.estimator is None else np.zeros((experiment.n, 2))
    clock = 0.0
    for part in schedule(experiment):
        clock = 0.0 if part.begins else clock
        changes = experiment.phases[part.index].reference is not None or estimates is not None
        commands = None
        for done in range(0, part.count, BLOCK):
            count = min(BLOCK, part.count - done)
            edges = np.add.accumulate(np.append(clock, np.full(count, part.period)))
            clock = float(edges[-1])
            if commands is None or changes:
                commands, estimates = _commands(experiment, part, edges, instants * part.period, estimates)
            yield Orders(part.index, count, commands)


def _instants(experiment: Experiment) -> Real:
    """(S,) instants of a period at which agents act, as shares of it: of a Runge-Kutta step its ends and its middle."""
    if experiment.plant != "single_integrator":
        return np.zeros(1)
    steps = runge_kutta_steps(experiment)
    each: Real = (np.arange(steps)[:, None] + [0.0, 0.5, 1.0]) / steps
    return each.reshape(-1)


def _commands(
    experiment: Experiment, part: Part, edges: Real, elapsed: Real, estimates: Real | None
) -> tuple[Commands, Real | None]:
    """The commands of the periods between edges (K + 1,), seconds into the phase, and the estimates after them."""
    from scenarios.simulation.compiled.period import Commands

    given = told(experiment.phases[part.index], edges[:-1, None], edges[1:, None], elapsed)
    velocity = given.velocity[:, :, None]
    if experiment.estimator is not None and estimates is not None:
        found = []
        for commanded in given.velocity[:, 0]:
            estimates = experiment.estimator.step(estimates, commanded, part.period)
            found.append(estimates)
        velocity = np.repeat(np.array(found)[:, None], len(elapsed), axis=1)
    delta = np.zeros_like(given.velocity) if given.delta is None else given.delta
    rate = given.rate if experiment.scenario.law.feedforward else np.zeros_like(given.rate)
    rates = np.ascontiguousarray(rate)[..., None].view(np.float64)
    return Commands(np.ascontiguousarray(velocity), np.ascontiguousarray(delta), rates, part.period), estimates
