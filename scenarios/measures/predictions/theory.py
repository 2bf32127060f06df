"""What the theory makes of an experiment: its closed loop, and the exact motion of its agents."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.analysis import first_follower
from formation.analysis.cascade import Cascade
from formation.analysis.exact import held, ideal, informed, points
from formation.plane import Complex, as_complex, as_vectors
from scenarios.definition.events.event import RESHAPE
from scenarios.definition.experiment import Experiment
from scenarios.simulation.schedule import pieces, schedule

Real = NDArray[np.float64]


def has_closed_loop(experiment: Experiment) -> bool:
    """Whether the loop is the cascade of eq. (man): the angle law, however its first follower is steered."""
    return experiment.scenario.law.name == "angle"


def moves_exactly(experiment: Experiment) -> bool:
    """Whether ideal agents move as :func:`motion` says: all active, no delay.

    On a reference, and where v_r spreads by consensus, the first follower stands still or is steered by displacement;
    without feed-forward, and without a message that is lost.
    """
    scenario = experiment.scenario
    simple = experiment.phases[0].reference is None and experiment.estimator is None
    linear = experiment.first_follower in ("stationary", "displacement") and not scenario.law.feedforward
    return (
        has_closed_loop(experiment)
        and scenario.law.activation == "simultaneous"
        and (simple or linear)
        and not (experiment.estimator is not None and scenario.communication.message_loss)
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


def motion(
    experiment: Experiment, start: Real, index: int, horizon: float = np.inf, continuous: bool | None = None
) -> Real:
    """(T, n, 2) where a phase takes the agents from ``start`` (n, 2), metres, at its start and after every period.

    Of the phase's first ``horizon`` seconds at most; of ``continuous`` agents or of held commands, as the plant has
    them where not said.
    """
    phase, found, begin = experiment.phases[index], [start[None]], 0.0
    spread = experiment.estimator is not None and moves_exactly(experiment)
    known = iter(estimates(experiment)[index]) if spread else None
    for count, period in pieces(phase, experiment.scenario.plant.control_period_s):
        here = as_complex(found[-1][-1])
        own = None if known is None else list(islice(known, count))
        moved = states(experiment, here, index, period, begin, own, continuous)
        found.append(points(moved, int(min(count, max(0.0, horizon - begin) / period)))[1:])
        begin += count * period
    return np.concatenate(found)


@lru_cache(maxsize=4)
def estimates(experiment: Experiment) -> list[list[Complex]]:
    """Of each phase, (n,) of each control period, complex m/s: what each agent takes v_r for, where it is spread."""
    found: list[list[Complex]] = [[] for _ in experiment.phases]
    known, start = np.zeros((experiment.n, 2)), 0.0
    for part in schedule(experiment):
        phase = experiment.phases[part.index]
        start = part.start if part.begins else start
        begin = part.start - start
        for step in range(part.count):
            velocity: Real = np.array(phase.velocity)
            if phase.reference is not None:
                velocity = as_vectors(phase.reference.velocity(begin + step * part.period))
            if experiment.estimator is not None:
                known = experiment.estimator.step(known, velocity, part.period)
            found[part.index].append(as_complex(known))
    return found


def states(
    experiment: Experiment,
    start: Complex,
    index: int,
    period: float,
    begin: float = 0.0,
    known: Sequence[Complex] | None = None,
    continuous: bool | None = None,
) -> Iterator[Complex]:
    """The motion of a phase from ``start`` (n, ...), complex metres, state by state, every ``period`` seconds.

    It begins so many seconds into the phase. Commands are held over a period where the plant holds them; neither wheels
    nor a filter change them. ``known`` is what each agent takes v_r for in each period; v_r where absent.
    """
    shaped, phase, first = experiment.of_phase(index), experiment.phases[index], experiment.first_follower
    loop = Cascade.of(shaped.target, gains=shaped.own_gains)
    if not (experiment.plant == "single_integrator" if continuous is None else continuous):
        return held(loop, start, phase, first, period, begin, known)
    if known is not None:
        return informed(loop, start, phase, first, period, known, begin)
    return ideal(loop, start, phase, first, period, begin)
