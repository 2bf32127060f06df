"""How the shape settles on a reference under a safety filter, which turns and slows whoever sees others ahead.

The filter is asked at instants of a cycle, of robots in their places that head along their ways; what it changes pushes
them off these, and it is asked again there, until nothing changes: a fixed point over the settled motion of
:mod:`formation.references.lag`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.plane import Complex, as_complex, as_vectors
from formation.references.lag import Settled, cycle
from formation.references.protocol import Reference
from robots.safety import SafetyFilter, make_filter
from scenarios.definition.experiment import Experiment

Real = NDArray[np.float64]

ROUNDS = 2
"""Of the reference, after which headings are settled."""

SWEEPS = 12
"""How often the filter is asked at most."""

UNCHANGED = 2e-5
"""Share of delta by which no place changes any more."""


def settled(experiment: Experiment, start: Real, reference: Reference, delta: complex, period: float) -> Complex:
    """(S, n) y_k over one cycle to which robots settle that hold commands, with the experiment's filter if it has one.

    Args:
        experiment: of the angle law, its first follower steered by displacement.
        start: (n, 2) initial projected points, metres.
        reference: that repeats.
        delta: delta(0), complex metres.
        period: for which commands are held, seconds.
    """
    told, t = experiment.scenario.law.feedforward, cycle(reference)
    motion = Settled(experiment.target, reference, told, experiment.own_gains, (delta, period))
    y, fleet = motion(), experiment.fleet
    safety = make_filter(
        experiment.safety, y.shape, fleet.drive, fleet.nid, experiment.filter_settings, experiment.arena
    )
    if safety is None:
        return y
    leader = as_complex(start)[agents.LEADER] + reference.path(t)[:, None]
    common = reference.velocity(t)[:, None]
    pushed = np.zeros_like(y)
    for _ in range(SWEEPS):
        relative = delta * (np.roll(y, -1, axis=0) - np.roll(y, 1, axis=0)) / (2.0 * (t[1] - t[0]))
        way = common + pushed[:, :1] + relative
        heading = _headings(way, t[1] - t[0], fleet.nid.projection_distance)
        pushed = _pushes(safety, leader + delta * y, heading, way - pushed, common, period)
        before, y = y, motion(pushed / delta)
        if np.abs(y - before).max() < UNCHANGED:
            break
    return y


def _pushes(
    safety: SafetyFilter, places: Complex, heading: Complex, law: Complex, common: Complex, period: float
) -> Complex:
    """(S, n) what a filter adds to the velocities ``law`` (S, n), v_r included, complex m/s in the common frame."""
    own, shared = (as_vectors(velocity * np.conj(heading)) for velocity in (law - common, common))
    return as_complex(safety.filter(as_vectors(places), as_vectors(heading), own, shared, period)) * heading - law


def _headings(way: Complex, step: float, ahead: float | Real) -> Complex:
    """(S, n) headings, as unit complex numbers, of robots whose points follow the way (S, n) of a cycle for a while.

    A heading at an angle phi from a velocity w that is held turns by phi' = -|w| sin(phi) / l, so that tan(phi / 2)
    shrinks by exp(-|w| step / l) in a step.
    """
    found, direction = np.empty_like(way), np.exp(1j * np.angle(way))
    shrinking = np.exp(-np.abs(way) * step / ahead)
    heading = direction[0]
    for _ in range(ROUNDS):
        for row in range(len(way)):
            found[row] = heading
            apart = np.angle(heading * np.conj(direction[row]))
            heading = direction[row] * np.exp(2j * np.arctan(np.tan(apart / 2.0) * shrinking[row]))
    return found
