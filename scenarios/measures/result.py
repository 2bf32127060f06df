"""``result.json``: what a run achieved, for people and for comparisons. Agents by number, angles in radians."""

from __future__ import annotations

import importlib.metadata
import platform
from typing import Any

import numpy as np

from robots.testbed import Occurrence, Violation
from scenarios.definition.experiment import Experiment
from scenarios.measures.clearance import Nearest, thing_name
from scenarios.measures.contacts import contacts
from scenarios.measures.happenings import happenings
from scenarios.measures.late_rates import predicted_late_rates
from scenarios.measures.metrics import Metrics, PhaseEnd
from scenarios.measures.safety_result import safety_result
from scenarios.measures.tracking import Tracking
from scenarios.measures.window import WINDOW, Window
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.result_schema import SCHEMA_VERSION

RECORDED_PACKAGES = ("angle-formation", "numpy", "pymunk", "numba", "daqp")
"""Versions that a result depends on."""


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def result(experiment: Experiment, seed: int, trajectory: Trajectory, metrics: Metrics) -> dict[str, Any]:
    """The content of ``result.json``."""
    final, axle_final = metrics.angle_errors[-1], _axle_errors(experiment, trajectory)
    closest = int(metrics.separation.distance.argmin())
    content: dict[str, Any] = {
        "schema_version": SCHEMA_VERSION,
        "scenario": experiment.file.name,
        "scenario_sha256": experiment.file.sha256,
        "seed": seed,
        "plant": experiment.plant,
        "safety": experiment.safety,
        "versions": versions(),
        "duration_s": float(trajectory.t[-1]),
        "planned_duration_s": float(sum(phase.duration for phase in experiment.phases)),
        "asked_duration_s": experiment.asked_duration,
        "outcome": metrics.outcome,
        "goal_rad": experiment.goal,
        "agents": list(experiment.numbers),
        "angles": [
            {
                "name": name,
                "target_deg": float(np.degrees(target)),
                "final_deg": _number(np.degrees(np.mod(target + error, 2.0 * np.pi))),
                "error_rad": _number(error),
                "axle_error_rad": _number(axle_error),
            }
            for name, target, error, axle_error in zip(
                experiment.angle_names, _end(experiment, trajectory).target_angles, final, axle_final, strict=True
            )
        ],
        "angle_error_sum_rad": _number(metrics.error_sum[-1]),
        "axle_angle_error_sum_rad": _number(metrics.axle_error_sum[-1]),
        "settling_time_s": metrics.settling_time,
        "min_separation": {
            "distance_m": _number(metrics.separation.distance[closest]),
            "time_s": float(trajectory.t[closest]),
            "agents": experiment.numbered(metrics.separation.pairs[closest]).tolist(),
        },
        "clearance": _clearance(experiment, trajectory, metrics),
        "contacts": contacts(experiment, trajectory),
        "testbed": {
            "accepted": metrics.verdict.accepted,
            "violations": [_violation(experiment, v) for v in metrics.verdict.violations],
        },
        "late_rates_per_s": {
            "predicted": predicted_late_rates(experiment, trajectory),
            "measured": metrics.late_rates,
        },
        "phases": [
            {
                "name": end.name,
                "end_s": float(trajectory.t[end.row]),
                "angle_errors_rad": [_number(e) for e in end.angle_errors],
                "axle_angle_errors_rad": [_number(e) for e in end.axle_angle_errors],
                "angle_error_sum_rad": _number(np.abs(end.angle_errors).sum()),
                "axle_angle_error_sum_rad": _number(np.abs(end.axle_angle_errors).sum()),
                **_against_prediction(experiment, metrics.tracking, end),
                "measured_m": trajectory.points[end.row].tolist(),
            }
            for end in metrics.phases
        ],
        **safety_result(experiment, trajectory),
        **happenings(experiment, trajectory, metrics),
    }
    if metrics.window is not None:
        _add_window(content, metrics.window)
    return content


def _add_window(content: dict[str, Any], window: Window) -> None:
    """What a run with noisy sensors is judged by, beside what it would be judged by without noise."""
    for angle, mean, rms in zip(content["angles"], window.mean[-1], window.rms[-1], strict=True):
        angle |= {"mean_error_rad": _number(mean), "rms_error_rad": _number(rms)}
    content["error_window_s"] = WINDOW
    content["mean_angle_error_sum_rad"] = _number(np.abs(window.mean[-1]).sum())
    content["rms_angle_error_sum_rad"] = _number(window.rms[-1].sum())


def _against_prediction(experiment: Experiment, tracking: Tracking, end: PhaseEnd) -> dict[str, Any]:
    """The end of a phase against where the theory sends it; null where the law has no theory."""
    if not experiment.predicted:
        keys = ("scale_error", "orientation_error_rad", "translation_error_m", "predicted_m", "distance_m")
        return dict.fromkeys(keys)
    return {
        "scale_error": _number(tracking.scale[end.row]),
        "orientation_error_rad": _number(tracking.orientation[end.row]),
        "translation_error_m": _number(tracking.translation[end.row]),
        "predicted_m": end.predicted.tolist(),
        "distance_m": [_number(d) for d in end.distances],
    }


def _clearance(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> dict[str, Any] | None:
    """The smallest distances from walls and obstacles, of a projected point and of a hull; null without either."""
    if metrics.clearance is None:
        return None

    def lowest(nearest: Nearest) -> dict[str, Any]:
        step = nearest.lowest
        return {
            "distance_m": _number(nearest.distance[step]),
            "time_s": float(trajectory.t[step]),
            "agent": experiment.number(int(nearest.row[step])),
            "thing": thing_name(int(nearest.thing[step])),
        }

    hulls = metrics.clearance.hulls
    return {"point": lowest(metrics.clearance.points), "hull": None if hulls is None else lowest(hulls)}


def versions() -> dict[str, str]:
    """Versions of what computed a result."""
    found = {name: importlib.metadata.version(name) for name in RECORDED_PACKAGES}
    return {"python": platform.python_version(), **found}


def _axle_errors(experiment: Experiment, trajectory: Trajectory) -> np.ndarray:
    return experiment.angles.errors(trajectory.poses[-1, :, :2], _end(experiment, trajectory).target_angles)


def _end(experiment: Experiment, trajectory: Trajectory) -> Experiment:
    """The experiment with the shape of the run's last phase."""
    return experiment.of_phase(trajectory.phase[-1])


def _number(value: float) -> float | None:
    """JSON has no NaN and no infinity."""
    return float(value) if np.isfinite(value) else None


def _violation(experiment: Experiment, violation: Violation) -> dict[str, Any]:
    return {
        "kind": violation.kind,
        "steps": violation.steps,
        "first": _occurrence(experiment, violation.first),
        "worst": _occurrence(experiment, violation.worst),
    }


def _occurrence(experiment: Experiment, occurrence: Occurrence) -> dict[str, Any]:
    return {
        "time_s": occurrence.time,
        "agents": experiment.numbered(occurrence.robots).tolist(),
        "place_m": [_number(coordinate) for coordinate in occurrence.place],
        "value": _number(occurrence.value),
    }
