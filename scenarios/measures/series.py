"""A run as columns over time, each with its unit in its name: what tables, frames and files of other programs hold."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory


def series(experiment: Experiment, trajectory: Trajectory, metrics: Metrics) -> dict[str, NDArray[Any]]:
    """Columns (T,) by name, a row per control period.

    ``t_s``; ``phase``, from 1; ``alpha(v;a,b).error_rad`` of each measured angle; ``angle_error_sum_rad``;
    ``min_separation_m``; and of each agent k, all with their agent's number: ``x_k_m`` and ``y_k_m`` of its projected
    point, ``axle_x_k_m`` and ``axle_y_k_m``, ``heading_k_rad`` (not wrapped), ``left_wheel_k_rad_per_s`` and
    ``right_wheel_k_rad_per_s`` (NaN for a plant without wheels), and ``intervention_k_m_per_s`` of the safety filter.
    """
    columns: dict[str, NDArray[Any]] = {"t_s": trajectory.t, "phase": trajectory.phase + 1}
    for name, error in zip(experiment.angle_names, metrics.angle_errors.T, strict=True):
        columns[f"{name}.error_rad"] = error
    columns["angle_error_sum_rad"] = metrics.error_sum
    columns["min_separation_m"] = metrics.separation.distance
    for row in range(experiment.n):
        columns |= _of_agent(trajectory, row, experiment.number(row))
    return columns


def _of_agent(trajectory: Trajectory, row: int, k: int) -> dict[str, NDArray[np.float64]]:
    (x, y), (axle_x, axle_y, heading) = trajectory.points[:, row].T, trajectory.poses[:, row].T
    left, right = trajectory.wheel_speeds[:, row].T
    return {
        f"x_{k}_m": x,
        f"y_{k}_m": y,
        f"axle_x_{k}_m": axle_x,
        f"axle_y_{k}_m": axle_y,
        f"heading_{k}_rad": heading,
        f"left_wheel_{k}_rad_per_s": left,
        f"right_wheel_{k}_rad_per_s": right,
        f"intervention_{k}_m_per_s": trajectory.intervention[:, row],
    }
