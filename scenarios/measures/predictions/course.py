"""What is known of a reference before it is run: how fast it asks everybody to move, and how far the shape will lag."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.plane import as_complex
from formation.references.lag import Settled, shape_residual
from robots.nid import mapped
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions import filtered
from scenarios.measures.predictions.theory import motion, moves_exactly
from scenarios.measures.tracking import following
from scenarios.simulation.schedule import periods

Real = NDArray[np.float64]

MOST_SAMPLES = 20_000
"""Instants at which a reference that never repeats is looked at."""


@dataclass(frozen=True)
class Outrun:
    """Where a reference first asks more of an agent than its wheels can do.

    Attributes:
        row: of the agent.
        time: seconds since the start.
        speed: of its projected point, m/s.
        share: its wheel speed over the limit, above 1.
    """

    row: int
    time: float
    speed: float
    share: float


@dataclass(frozen=True, eq=False)
class Course:
    """A reference as agents follow it that are in their places and do not lag.

    Attributes:
        speed: (n,) the largest speed of each agent's projected point, m/s.
        turning: largest rate at which the formation turns, rad/s.
        scaling: largest rate at which it scales, 1/s.
        outrun: where it first asks too much of wheels; None where it never does, and for points, which have none.
        lag: largest and root-mean-square shape residual over a cycle, once settled, or, where nothing repeats, over the
            run from the agents' places; None where nothing says it.
    """

    speed: Real
    turning: float
    scaling: float
    outrun: Outrun | None
    lag: tuple[float, float] | None


def course(experiment: Experiment, start: Real) -> Course | None:
    """The course from a start (n, 2), metres; None where phases are constant or the law has no theory."""
    phase = experiment.phases[0]
    if phase.reference is None or not experiment.predicted:
        return None
    count, period = periods(phase, experiment.scenario.plant.control_period_s)
    if phase.reference.cycle is not None:
        count = min(count, int(np.ceil(phase.reference.cycle / period)))
    step = period * max(1.0, count / MOST_SAMPLES)
    steps = max(2, round(count * period / step))
    t: Real = np.linspace(0.0, steps * step, steps + 1)
    points = following(experiment, start, t)
    velocity = np.ascontiguousarray(np.diff(points, axis=0) / step).view(np.complex128)[..., 0]
    rate = phase.reference.rate(t)
    return Course(
        speed=np.abs(velocity).max(axis=0),
        turning=float(np.abs(rate.imag).max()),
        scaling=float(np.abs(rate.real).max()),
        outrun=None if experiment.plant == "single_integrator" else _outrun(experiment, velocity, t, step),
        lag=_lag(experiment, start),
    )


def _outrun(experiment: Experiment, velocity: NDArray[np.complex128], t: Real, step: float) -> Outrun | None:
    """The first wheel beyond its limit, of robots whose headings follow velocities (T, n) as the NID map turns them."""
    fleet = experiment.fleet
    to_wheels = (fleet.drive.to_wheels @ fleet.nid.to_twist).swapaxes(-1, -2)
    ahead, limit = fleet.nid.projection_distance, fleet.drive.wheel_speed_limit
    moving = np.abs(velocity) > 0.0
    first = velocity[moving.argmax(axis=0), np.arange(velocity.shape[1])]
    heading = np.exp(1j * np.angle(first))
    for row, wanted in enumerate(velocity):
        body = wanted * np.conj(heading)
        wheels = np.abs(mapped(np.stack([body.real, body.imag], axis=-1), to_wheels)).max(axis=-1) / limit
        agent = int(wheels.argmax())
        if wheels[agent] > 1.0 + 1e-9:
            return Outrun(agent, float(t[row]), float(np.abs(wanted[agent])), float(wheels[agent]))
        heading = heading * np.exp(1j * body.imag * (step / ahead))
    return None


def _lag(experiment: Experiment, start: Real) -> tuple[float, float] | None:
    reference, scenario = experiment.phases[0].reference, experiment.scenario
    if reference is not None and reference.cycle is None:
        return _lag_from_places(experiment, start)
    if (
        reference is None
        or scenario.law.name != "angle"
        or experiment.first_follower != "displacement"
        or scenario.sensor.delay_periods
        or experiment.estimator is not None
    ):
        return None
    told, delta = scenario.law.feedforward, experiment.phases[0].displacement
    if experiment.plant == "single_integrator" or delta is None:
        y = Settled(experiment.target, reference, told, experiment.own_gains)()
    else:
        period = periods(experiment.phases[0], scenario.plant.control_period_s)[1]
        y = filtered.settled(experiment, start, reference, delta, period)
    return _largest_and_rms(experiment, y)


def _lag_from_places(experiment: Experiment, start: Real) -> tuple[float, float] | None:
    """The same on a reference that never repeats: of the exact motion from the agents' places, over the whole run."""
    if not moves_exactly(experiment):
        return None
    return _largest_and_rms(experiment, as_complex(motion(experiment, following(experiment, start, np.zeros(1))[0], 0)))


def _largest_and_rms(experiment: Experiment, places: NDArray[np.complex128]) -> tuple[float, float]:
    residual = shape_residual(experiment.target, places)
    return float(residual.max()), float(np.sqrt((residual**2).mean()))


def too_fast(experiment: Experiment, start: Real) -> list[str]:
    """One sentence where a reference asks more than wheels can do, from a start (n, 2), metres."""
    found = course(experiment, start)
    if found is None or found.outrun is None:
        return []
    outrun = found.outrun
    return [
        f"the reference asks {agents.name(outrun.row)} for {outrun.speed:.3f} m/s at {outrun.time:.1f} s, its wheels "
        f"for {outrun.share:.2f} times their limit: it falls behind from there on"
    ]
