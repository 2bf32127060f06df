"""What the theory makes of an experiment: its closed loop, and the exact motion of its agents."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.analysis import first_follower
from formation.analysis.cascade import Cascade
from formation.analysis.exact import held, ideal, points
from formation.plane import Complex, as_complex
from scenarios.definition.events.event import RESHAPE
from scenarios.definition.experiment import Experiment
from scenarios.simulation.schedule import pieces

Real = NDArray[np.float64]


def has_closed_loop(experiment: Experiment) -> bool:
    """Whether the loop is the cascade of eq. (man): the angle law, however its first follower is steered."""
    return experiment.scenario.law.name == "angle"


def moves_exactly(experiment: Experiment) -> bool:
    """Whether ideal agents move as :func:`motion` says: all active, v_r known to all, no delay; on a reference without
    feed-forward, behind a first follower that stands still or is steered by displacement."""
    scenario = experiment.scenario
    followed = experiment.first_follower in ("stationary", "displacement") and not scenario.law.feedforward
    return (
        has_closed_loop(experiment)
        and scenario.law.activation == "simultaneous"
        and experiment.estimator is None
        and (experiment.phases[0].reference is None or followed)
        and all(event.kind == RESHAPE for event in experiment.events)
        and not scenario.sensor.delay_periods
    )


def cascade(experiment: Experiment, start: Real, index: int) -> Cascade:
    """The closed loop near the end of a phase that begins with agents at ``start`` (n, 2), metres."""
    leader, first = as_complex(start)[: agents.FIRST_ORDINARY]
    delta = experiment.phases[index].displacement
    rate = first_follower.rate(experiment.first_follower, first - leader, delta)
    shaped = experiment.of_phase(index)
    return Cascade.of(shaped.target, rate, shaped.own_gains)


def motion(experiment: Experiment, start: Real, index: int, horizon: float = np.inf) -> Real:
    """(T, n, 2) where a phase takes the agents from ``start`` (n, 2), metres, at its start and after every period.

    Of the phase's first ``horizon`` seconds at most.
    """
    phase, found, begin = experiment.phases[index], [start[None]], 0.0
    for count, period in pieces(phase, experiment.scenario.plant.control_period_s):
        moved = states(experiment, as_complex(found[-1][-1]), index, period, begin)
        found.append(points(moved, int(min(count, max(0.0, horizon - begin) / period)))[1:])
        begin += count * period
    return np.concatenate(found)


def states(experiment: Experiment, start: Complex, index: int, period: float, begin: float = 0.0) -> Iterator[Complex]:
    """The motion of a phase from ``start`` (n, ...), complex metres, state by state, every ``period`` seconds.

    It begins so many seconds into the phase. Commands are held over a period where the plant holds them; neither wheels
    nor a filter change them.
    """
    move = ideal if experiment.plant == "single_integrator" else held
    shaped = experiment.of_phase(index)
    loop = Cascade.of(shaped.target, gains=shaped.own_gains)
    return move(loop, start, experiment.phases[index], experiment.first_follower, period, begin)
