"""What agents are told at an instant of a phase: v_r, delta and mu; the same for all runs, and no run is known here."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formation import Phase
from formation.plane import as_vectors
from scenarios.definition.experiment import Experiment

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

INSIDE = 1e-9
"""Share of a period by which its ends are inside of it: above the rounding of the time."""

TURN_OF_STEP = 0.5
"""1/s: the largest mu, how fast the formation turns or scales, for which a step a period is enough."""

RATE_SAMPLES = 4096
"""Instants of a run at which mu is looked at."""


class Told(NamedTuple):
    """What agents are told at instants (...).

    Attributes:
        velocity: (..., 2) v_r, m/s, in the common frame.
        delta: (..., 2) displacement of agent 2 from agent 1, metres; None where none is told.
        rate: (...) mu = delta' / delta, 1/s.
    """

    velocity: Real
    delta: Real | None
    rate: Complex


def told(phase: Phase, begin: Real | float, end: Real | float, elapsed: Real | float) -> Told:
    """What agents are told, ``elapsed`` seconds after the begin of a control period.

    Args:
        phase: of the run.
        begin, end: of the period, seconds into the phase.
        elapsed: seconds.
    """
    t = np.asarray(begin + elapsed, dtype=np.float64)
    reference = phase.reference
    if reference is None:
        still = None if phase.delta is None else np.broadcast_to(np.array(phase.delta), (*t.shape, 2))
        velocity = np.broadcast_to(np.array(phase.velocity), (*t.shape, 2))
        return Told(velocity, still, np.zeros(t.shape, dtype=np.complex128))
    if reference.bends.size:  # where mu jumps, each period is told its own side
        inside = INSIDE * (np.asarray(end) - begin)
        t = np.minimum(np.maximum(t, begin + inside), end - inside)
    delta = None if phase.displacement is None else as_vectors(phase.displacement * reference.factor(t))
    return Told(as_vectors(reference.velocity(t)), delta, reference.rate(t))


def runge_kutta_steps(experiment: Experiment) -> int:
    """How many steps the single integrator takes in a control period: one for each :data:`TURN_OF_STEP` of mu.

    On a circle, mu = i omega, a step h leaves the first follower by displacement off by the share h^4 omega^2 (24 i
    omega^3 - 75 omega^2 - 80 i omega + 30) / 2880 of delta: at 1 rad/s and 33 ms, that is 3e-8. The number does not
    depend on the period, so that errors fall with its fourth power.
    """
    phase = experiment.phases[0]
    if phase.reference is None or not experiment.scenario.law.feedforward:
        return 1
    fastest = np.abs(phase.reference.rate(np.linspace(0.0, phase.duration, RATE_SAMPLES))).max()
    return max(1, int(np.ceil(fastest / TURN_OF_STEP)))
