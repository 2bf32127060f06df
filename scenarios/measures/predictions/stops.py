"""What a robot that stops does to the others, before the run: how far off each is when the stop ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.analysis import first_follower
from formation.analysis.cascade import Cascade
from formation.analysis.exact import spread
from formation.plane import as_complex
from scenarios.definition.events.event import STOP, Event
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.theory import has_closed_loop
from scenarios.measures.tracking import moving_ends

Real = NDArray[np.float64]

STEP = 0.05
"""Seconds between two places of the stopped agent."""


@dataclass(frozen=True, eq=False)
class Spread:
    """The errors that a stop leaves at one time.

    Attributes:
        event: the stop.
        time: when it ends, or the run does, seconds.
        errors: (n,) distance of each agent from where it would be without the stop, metres.
    """

    event: Event
    time: float
    errors: Real


def spreads(experiment: Experiment, start: Real) -> list[Spread]:
    """What each stop does to a formation that has settled before it, from agents at ``start`` (n, 2), metres.

    Of the angle law whose first follower is stationary or steered by displacement, v_r known to all, along phases.
    """
    if not covered(experiment):
        return []
    length = sum(phase.duration for phase in experiment.phases)
    found = []
    for event in experiment.events:
        if event.kind != STOP or event.row is None or event.begin >= length:
            continue
        until = min(event.end, length)
        t = np.linspace(event.begin, until, max(2, round((until - event.begin) / STEP)))
        ends = np.cumsum([phase.duration for phase in experiment.phases])
        index = np.minimum(np.searchsorted(ends, t, side="right"), len(ends) - 1)
        without = as_complex(moving_ends(experiment, start, t, index))
        shaped = experiment.of_phase(int(index[0]))
        rate = 0.0
        if experiment.first_follower == "displacement":
            leader, first = without[0, : agents.FIRST_ORDINARY]
            rate = first_follower.rate("displacement", first - leader, experiment.phases[int(index[0])].displacement)
        loop = Cascade.of(shaped.target, rate, shaped.own_gains)
        own = without[0, event.row] - without[:, event.row]
        errors = spread(loop, event.row, own, t)[-1]
        found.append(Spread(event, until, np.abs(errors)))
    return found


def covered(experiment: Experiment) -> bool:
    """Whether the loop around a stopped robot is linear, and nothing else keeps robots from their law."""
    scenario = experiment.scenario
    return (
        has_closed_loop(experiment)
        and experiment.first_follower in ("stationary", "displacement")
        and experiment.estimator is None
        and scenario.law.activation == "simultaneous"
        and scenario.law.without_neighbour != "another-pair"
        and experiment.phases[0].reference is None
    )
