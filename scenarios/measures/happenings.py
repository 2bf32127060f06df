"""What events did to a run, for ``result.json``: the error before and after each, and how long it took to recover."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenarios.definition.events.event import STOP, Event
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import Metrics
from scenarios.measures.predictions.stops import spreads
from scenarios.simulation.trajectory import Trajectory


def happenings(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> dict[str, Any]:
    """The key ``events`` of a single run; no key where nothing was to happen."""
    if not experiment.events:
        return {}
    predicted = {each.event.number: each.errors for each in spreads(experiment, trajectory.points[0])}
    told = []
    for event in experiment.events:
        content = _one(experiment, trajectory, metrics, event)
        if event.kind == STOP and event.number in predicted and content["happened"]:
            row = _row(trajectory, min(event.end, float(trajectory.t[-1])))
            content["offsets_m"] = {
                "time_s": float(trajectory.t[row]),
                "predicted": [_number(x) for x in predicted[event.number]],
                "measured": [_number(x) for x in metrics.tracking.distances[row]],
            }
        told.append(content)
    return {"events": told}


def _one(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, event: Event) -> dict[str, Any]:
    """An event, the sum of the angle errors when it begins, the largest until the next one, and when that is over."""
    t, errors = trajectory.t, metrics.error_sum
    content: dict[str, Any] = {
        "event": event.number,
        "kind": event.kind,
        "what": event.what,
        "begin_s": event.begin,
        "end_s": None if event.end == np.inf else event.end,
        "happened": bool(event.begin < t[-1]),
    }
    if event.row is not None:
        content["agent"] = experiment.number(event.row)
    if event.pair is not None:
        content["edge"] = experiment.numbered(event.pair).tolist()
    if not content["happened"]:
        return content
    first = _row(trajectory, event.begin)
    later = [other.begin for other in experiment.events if event.begin < other.begin < t[-1]]
    end = len(t) if not later else _row(trajectory, min(later)) + 1
    after = errors[first + 1 : end]
    worst = first + 1 + int(np.nanargmax(after)) if np.isfinite(after).any() else first
    below = np.flatnonzero(errors[worst:end] < experiment.goal)
    return content | {
        "angle_error_sum_before_rad": _number(errors[first]),
        "largest_angle_error_sum_rad": _number(errors[worst]),
        "largest_at_s": float(t[worst]),
        "recovered_at_s": float(t[worst + below[0]]) if below.size else None,
    }


def _row(trajectory: Trajectory, time: float) -> int:
    """The row of the state at a time, seconds."""
    return int(np.abs(trajectory.t - time).argmin())


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
