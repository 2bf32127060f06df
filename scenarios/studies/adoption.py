"""A log of the testbed as a run folder: verdict, angles, figures and recording as of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from formation import agents
from robots import NearIdentityDiffeomorphism
from robots.identification.log import LogError
from robots.identification.odometry import RADIANS_PER_COUNT, filled
from robots.identification.reading import Arrays, read_all
from robots.safety.protocol import BLOCKERS
from robots.worlds import NOTHING
from scenarios.definition.experiment import Experiment, build
from scenarios.definition.load import ScenarioFile, load, validate
from scenarios.definition.schema import RobotTable
from scenarios.errors import InputError
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]

LEAST_ROBOTS = 3
"""Of a formation."""


def adopt(path: Path, scenario: str | None, changes: tuple[str, ...], period: float) -> tuple[Experiment, Trajectory]:
    """The experiment that a log is a run of, from the log's own start, and what the log says happened.

    Args:
        path: the log, robots in the order of the agents.
        scenario: a library name or a path; None measures the log by the shape that it ends in.
        changes: ``key=value`` texts.
        period: seconds of a turn of the loop, where the log has no times.

    Raises:
        InputError: the log or the scenario cannot be used, or they have different numbers of robots.
    """
    try:
        arrays = read_all(path)
    except LogError as error:
        raise InputError(f"{path}: {error}") from error
    if arrays.robots < LEAST_ROBOTS:
        raise InputError(f"{path}: expected {LEAST_ROBOTS} robots or more, got {arrays.robots}; `identify` reads one")
    poses = _continuous(path, arrays)
    t: Real = period * np.arange(float(len(poses))) if arrays.times is None else arrays.times - arrays.times[0]
    file = _by_its_end(path, poses) if scenario is None else load(scenario, changes)
    number = len(file.scenario.agents)
    if number != arrays.robots:
        raise InputError(f"{path}: expected {number} robots, as many as {file.name} has agents, got {arrays.robots}")
    points = NearIdentityDiffeomorphism(file.scenario.robot.projection_distance_m).project(poses)
    experiment = build(_started(file, path.name, points[0], poses[0, :, 2]), float(t[-1]))
    return experiment, _trajectory(experiment, t, poses, points, arrays)


def _continuous(path: Path, arrays: Arrays) -> Real:
    """(T, n, 3) poses, what the cameras missed put in between, headings not wrapped."""
    poses = np.moveaxis(arrays.poses, 2, 1).copy()
    for robot in range(arrays.robots):
        good = np.isfinite(poses[:, robot]).all(axis=1)
        if good.sum() < 2:
            raise InputError(f"{path}: robot {robot + 1} has no poses")
        poses[~good, robot] = np.nan
        poses[good, robot, 2] = np.unwrap(poses[good, robot, 2])
        poses[:, robot] = filled(poses[:, robot])
    return poses


def _by_its_end(path: Path, poses: Real) -> ScenarioFile:
    """A scenario whose shape is the one that the log ends in."""
    entries: list[dict[str, Any]] = []
    ends = NearIdentityDiffeomorphism(RobotTable().projection_distance_m).project(poses[-1])
    for row, target in enumerate(ends.tolist()):
        neighbours = [[], [1], [1, 2]][row] if row < 3 else [row - 1, row]
        entries.append({"id": agents.number(row), "neighbours": neighbours, "target": target, "start": target})
    content = {"title": "The shape that a log ends in", "duration_s": 1.0, "agents": entries}
    return ScenarioFile(path.stem, str(path), "", validate(content, str(path)))


def _started(file: ScenarioFile, log: str, points: Real, theta: Real) -> ScenarioFile:
    """The same scenario, begun where the log begins."""
    begun = []
    for agent in file.scenario.agents:
        row = int(agents.rows(agent.id))
        heading = float(np.degrees(np.arctan2(np.sin(theta[row]), np.cos(theta[row]))))
        start = (float(points[row, 0]), float(points[row, 1]))
        begun.append(agent.model_copy(update={"start": start, "heading_deg": heading}))
    changed = {"agents": tuple(begun), "random_start": None, "source": f"adopted from the testbed's log {log}"}
    return ScenarioFile(file.name, file.path, file.description, file.scenario.model_copy(update=changed), file.law)


def _trajectory(experiment: Experiment, t: Real, poses: Real, points: Real, arrays: Arrays) -> Trajectory:
    ends = np.cumsum([phase.duration for phase in experiment.phases])
    robots = poses.shape[:2]
    return Trajectory(
        t=t,
        poses=poses,
        points=points,
        wheel_speeds=_wheel_speeds(experiment, t, poses, arrays),
        phase=np.minimum(np.searchsorted(ends, t, side="left"), len(ends) - 1).astype(np.intp),
        contact=np.full(robots, NOTHING),
        active=np.ones(robots, dtype=bool),
        intervention=np.zeros(robots),
        relaxation=np.zeros(robots),
        blockers=np.full((*robots, BLOCKERS), -1, dtype=np.int32),
        stuck=np.zeros(robots),
        wish=np.full((*robots, 2), np.nan),
        command=np.full((*robots, 2), np.nan),
    )


def _wheel_speeds(experiment: Experiment, t: Real, poses: Real, arrays: Arrays) -> Real:
    """(T, n, 2) by the encoders, or by the poses and the data sheet where there are none; no faster than the wheels.

    Readings that come late in pairs, and poses that jitter, show speeds that no wheel had: they are not what was
    commanded, which alone the testbed judges.
    """
    dt = np.diff(t)[:, None, None]
    if arrays.counts is not None and arrays.counts.shape[2] == poses.shape[1]:
        counts = np.moveaxis(arrays.counts, 2, 1)
        speeds = RADIANS_PER_COUNT * np.nan_to_num(np.diff(counts, axis=0)) / dt
    else:
        step = np.diff(poses, axis=0)
        middle = (poses[1:, :, 2] + poses[:-1, :, 2]) / 2.0
        ahead = step[..., 0] * np.cos(middle) + step[..., 1] * np.sin(middle)
        speeds = experiment.robot.drive.wheel_speeds(np.stack([ahead, step[..., 2]], axis=-1) / dt)
    limit = experiment.robot.drive.wheel_speed_limit
    return np.concatenate([np.zeros((1, *speeds.shape[1:])), np.clip(speeds, -limit, limit)])
