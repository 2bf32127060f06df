"""The late decay rate of each follower: the slope of its log distance over one window, measured and predicted alike.

The rate that an error has in the end, the slowest upstream, is another number: where rates lie close together, or
repeat, a distance takes longer than any run to get there. So prediction and measurement are the same fit: the measured
one to the recorded states, the predicted one to the exact motion of the closed loop.
"""

from __future__ import annotations

from itertools import islice

import numpy as np
from numpy.typing import NDArray

from formation import agents, end_configuration
from formation.plane import as_complex, as_vectors
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.theory import has_closed_loop, motion, states
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Window = tuple[int, int]

FIT_NEAR, FIT_FAR = 1e-7, 2e-2
"""Metres between which a distance is taken to decay with its late rate: below the far transient, above rounding."""

FIT_ROWS = 20
"""Fewest recorded states that a rate is fitted to."""

HORIZON = 1800.0
"""Seconds of a phase that are looked at before a run; by then all that settles has."""

LAUNCHES = 64
"""Instants from which the exact motion is computed: each serves the followers whose windows begin until the next."""


def measured_late_rates(experiment: Experiment, trajectory: Trajectory) -> list[float | None]:
    """The late decay rate, 1/s, of each follower's distance from where agents 1 and 2 put it, in the last phase.

    Agents 1 and 2 count where they are, not where they should be: contact may have moved them. None where too few
    states lie between :data:`FIT_NEAR` and :data:`FIT_FAR`.
    """
    found = _last_phase(experiment, trajectory)
    if found is None:
        return _nothing(experiment)
    t, points, places = found
    experiment = experiment.of_phase(trajectory.phase[-1])
    return [_rate(t, distance, window) for distance, window in _windows(experiment, points, places)]


@np.errstate(over="ignore", invalid="ignore")  # held commands of a law that is too fast for them grow beyond numbers
def predicted_late_rates(experiment: Experiment, trajectory: Trajectory) -> list[float | None] | None:
    """What the theory says of the same windows: the fit to the exact motion from the state at which each begins.

    Before that the wheels, a filter or contact may have had their say; from there on the law alone decides. None but
    for the angle law.
    """
    if not has_closed_loop(experiment):
        return None
    found = _last_phase(experiment, trajectory)
    if found is None:
        return _nothing(experiment)
    t, points, places = found
    windows = [window for _, window in _windows(experiment.of_phase(trajectory.phase[-1]), points, places)]
    rates = _nothing(experiment)
    fitted = sorted((*window, k) for k, window in enumerate(windows) if window is not None)
    if not fitted:
        return rates
    several = 1 if experiment.plant == "single_integrator" else LAUNCHES  # nothing ever moves points but their law
    groups = [fitted[g[0] : g[-1] + 1] for g in np.array_split(np.arange(len(fitted)), several) if g.size]
    launches = np.array([group[0][0] for group in groups])
    columns = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    _, end, k = np.array(fitted).T
    start = as_complex(points[launches]).T
    length = (end - launches[columns]).max()
    period = (t[-1] - t[0]) / (len(t) - 1)
    moved = states(experiment, start, int(trajectory.phase[-1]), period)
    followers = np.stack([state[k + agents.FIRST_ORDINARY, columns] for state in islice(moved, length)])
    for column, (first, last, follower) in enumerate(fitted):
        launch = launches[columns[column]]
        exact = as_vectors(followers[first - launch : last - launch, column])
        distance = np.linalg.norm(exact - places[first:last, follower + agents.FIRST_ORDINARY], axis=-1)
        rates[follower] = _slope(t[first:last], distance)
    return rates


@np.errstate(over="ignore", invalid="ignore")
def expected_late_rates(experiment: Experiment, start: Real) -> list[float | None] | None:
    """What the theory says before a run from ``start`` (n, 2), metres, of ideal agents; None but for the angle law."""
    if not has_closed_loop(experiment) or experiment.phases[0].reference is not None:
        return None
    for index, phase in enumerate(experiment.phases):
        points = motion(experiment, start, index, HORIZON)
        duration = min(phase.duration, HORIZON)
        start = points[-1] + (phase.duration - duration) * np.array(phase.velocity)
    t = np.linspace(0.0, duration, len(points))
    experiment = experiment.of_phase(-1)
    places = _places(experiment, t, points, phase.velocity)
    if places is None:
        return _nothing(experiment)
    return [_rate(t, distance, window) for distance, window in _windows(experiment, points, places)]


def _last_phase(experiment: Experiment, trajectory: Trajectory) -> tuple[Real, Real, Real] | None:
    """Times (T',), points and places (T', n, 2) of the last phase; None where it has no end to rest at."""
    if experiment.phases[-1].reference is not None:
        return None
    last = trajectory.phase == trajectory.phase[-1]
    points, t = trajectory.points[last], trajectory.t[last]
    shaped, velocity = experiment.of_phase(trajectory.phase[-1]), experiment.phases[trajectory.phase[-1]].velocity
    places = _places(shaped, t, points, velocity)
    return None if places is None else (t, points, places)


def _places(experiment: Experiment, t: Real, points: Real, velocity: tuple[float, float]) -> Real | None:
    """(T', n, 2) where the last positions of agents 1 and 2 put everybody, carried back with v_r, metres."""
    leader, first = points[-1, : agents.FIRST_ORDINARY]
    if (leader == first).all() or not np.isfinite(points).all():
        return None
    ahead = (t[-1] - t)[:, None] * np.array(velocity)
    return end_configuration(experiment.formation, leader, first) - ahead[:, None, :]


def _windows(experiment: Experiment, points: Real, places: Real) -> list[tuple[Real, Window | None]]:
    """Each follower's distance (T',), metres, and the rows [begin, end) to which a rate is fitted.

    A window begins when the follower and all upstream of it stay within :data:`FIT_FAR`: until then wheels at their
    limit, its own or another's, may decide how its distance changes.
    """
    distances = np.linalg.norm(points - places, axis=-1).T
    begins: list[int] = []
    for distance in distances:
        far = np.flatnonzero(distance > FIT_FAR)
        begins.append(int(far[-1]) + 1 if far.size else 0)
    if experiment.aim.target is not None:
        graph = experiment.aim.target.graph
        for k, (i, j) in zip(graph.followers.tolist(), graph.neighbours.tolist(), strict=True):
            begins[k] = max(begins[k], begins[i], begins[j])
    found: list[tuple[Real, Window | None]] = []
    for distance, begin in zip(distances[agents.FIRST_ORDINARY :], begins[agents.FIRST_ORDINARY :], strict=True):
        near = np.flatnonzero(distance[begin:] < FIT_NEAR)
        end = begin + int(near[0]) if near.size else len(points)
        found.append((distance, None if end - begin < FIT_ROWS else (begin, end)))
    return found


def _rate(t: Real, distance: Real, window: Window | None) -> float | None:
    return None if window is None else _slope(t[slice(*window)], distance[slice(*window)])


@np.errstate(divide="ignore")
def _slope(t: Real, distance: Real) -> float | None:
    logarithm = np.log(distance)
    return float(-np.polyfit(t - t[0], logarithm, 1)[0]) if np.isfinite(logarithm).all() else None


def _nothing(experiment: Experiment) -> list[float | None]:
    return [None] * (experiment.n - agents.FIRST_ORDINARY)
