"""From a validated scenario to the objects of the theory and of the machines."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import AngleLaw, AngleSet, Phase, SensingGraph, TargetFormation, agents, end_similarity, wrap
from robots import GTERNAL, Arena, Chassis, DifferentialDrive, NearIdentityDiffeomorphism, RobotModel
from robots import RelativePositionSensor as Sensor
from scenarios.errors import InputError, located
from scenarios.load import ScenarioFile, load
from scenarios.schema import Scenario

Real = NDArray[np.float64]

PRINTED_DEGREES = 0.005
"""Degrees by which an angle that is listed with two decimals may differ from the exact one."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """Everything that a run needs, ready to use.

    Attributes:
        file: the scenario with its origin.
        target: the target formation with its sensing graph.
        angles: the angles that are measured and compared.
        target_angles: (m,) their targets, radians, exact.
        start: (n, 2) initial projected points, metres.
        headings: (n,) initial headings, radians; NaN where the seed decides.
        phases: the maneuver, a single phase for shape control.
    """

    file: ScenarioFile
    target: TargetFormation
    angles: AngleSet
    target_angles: Real
    start: Real
    headings: Real
    phases: tuple[Phase, ...]
    law: AngleLaw
    sensor: Sensor
    nid: NearIdentityDiffeomorphism
    robot: RobotModel
    arena: Arena

    @property
    def scenario(self) -> Scenario:
        return self.file.scenario

    @property
    def plant(self) -> str:
        return self.scenario.plant.name

    @property
    def graph(self) -> SensingGraph:
        return self.target.graph

    @property
    def n(self) -> int:
        """Number of agents."""
        return self.graph.n

    @property
    def goal(self) -> float:
        """Bound on the sum of the absolute angle errors, radians."""
        return self.scenario.goal.angle_error_sum_rad


def open_experiment(scenario: str, changes: tuple[str, ...] = (), duration: float | None = None) -> Experiment:
    """The experiment of a scenario's name or path, with ``--set`` changes and a shortened or lengthened run.

    Raises:
        InputError: anything in the scenario that cannot be used, with file and field.
    """
    return build(load(scenario, changes), duration)


def build(file: ScenarioFile, duration: float | None = None) -> Experiment:
    """The experiment of a scenario file; ``duration`` (seconds) replaces the scenario's own.

    Raises:
        InputError: anything in the scenario that cannot be used, with file and field.
    """
    scenario, path = file.scenario, file.path
    ordered = sorted(scenario.agents, key=lambda agent: agent.id)
    n = len(ordered)
    with located(path, "agents"):
        edges = [(a.id, neighbour) for a in ordered for neighbour in a.neighbours]
        graph = SensingGraph.from_edges(n, agents.rows(edges))
        target = TargetFormation(graph, _vectors(path, "target", [a.target for a in ordered]))
    angles, target_angles = _angles(path, scenario, target)
    start = _vectors(path, "start", [a.start for a in ordered])
    with located(path, "agents[id 2].start"):
        end_similarity(target, start[agents.LEADER], start[agents.FIRST_FOLLOWER])
    with located(path, "robot"):
        robot = _robot(scenario)
        nid = NearIdentityDiffeomorphism(scenario.robot.projection_distance_m)
    with located(path, "arena"):
        arena = Arena(scenario.arena.x_m, scenario.arena.y_m, scenario.arena.walls)
    return Experiment(
        file=file,
        target=target,
        angles=angles,
        target_angles=target_angles,
        start=start,
        headings=np.radians([np.nan if a.heading_deg is None else a.heading_deg for a in ordered]),
        phases=_phases(path, scenario, duration),
        law=AngleLaw(target, scenario.law.first_follower),
        sensor=Sensor(graph.edges, scenario.sensor.position_noise_m, np.radians(scenario.sensor.bearing_noise_deg)),
        nid=nid,
        robot=robot,
        arena=arena,
    )


def _vectors(path: str, key: str, values: list[tuple[float, float] | None]) -> Real:
    for row, value in enumerate(values):
        if value is None:
            raise InputError(f"{path}: agents[id {agents.number(row)}].{key}: missing")
    return np.array(values, dtype=np.float64)


def _robot(scenario: Scenario) -> RobotModel:
    drive, chassis, table = GTERNAL.drive, GTERNAL.chassis, scenario.robot
    return RobotModel(
        drive=DifferentialDrive(drive.wheel_radius, drive.base_length, table.wheel_speed_limit_rad_s),
        chassis=Chassis(
            length=chassis.length,
            width=chassis.width,
            centre_offset=chassis.centre_offset,
            mass=chassis.mass,
            tyre_friction=table.tyre_friction,
            body_friction=table.body_friction,
        ),
    )


def _angles(path: str, scenario: Scenario, target: TargetFormation) -> tuple[AngleSet, Real]:
    listed = scenario.target.angles_deg
    if not listed:
        angles = AngleSet.of_followers(target.graph)
        return angles, angles.measure(target.positions)
    triples = []
    for name in listed:
        match = re.fullmatch(r"\s*(\d+)\s*;\s*(\d+)\s*,\s*(\d+)\s*", name)
        if match is None:
            raise InputError(f"{path}: target.angles_deg: expected a name as in '3;2,4', got {name!r}")
        triple = [int(number) for number in match.groups()]
        for number in triple:
            if not 1 <= number <= target.graph.n:
                raise InputError(
                    f"{path}: target.angles_deg: {name!r} names agent {number} outside 1..{target.graph.n}"
                )
        triples.append(agents.rows(triple))
    with located(path, "target.angles_deg"):
        angles = AngleSet(np.array(triples))
    exact = angles.measure(target.positions)
    for name, degrees, radians in zip(listed, listed.values(), exact, strict=True):
        difference = abs(np.degrees(wrap(np.radians(degrees) - radians)))
        if not difference <= PRINTED_DEGREES + 1e-9:
            raise InputError(
                f"{path}: target.angles_deg.{name!r}: the target positions have {np.degrees(radians):.4f} degrees, "
                f"got {degrees:g}"
            )
    return angles, exact


def _phases(path: str, scenario: Scenario, duration: float | None) -> tuple[Phase, ...]:
    if duration is not None and not (np.isfinite(duration) and duration > 0.0):
        raise InputError(f"--duration: expected a positive number of seconds, got {duration:g}")
    stationary = scenario.law.first_follower == "stationary"
    if not scenario.phases:
        if not stationary:
            raise InputError(f"{path}: law.first_follower: {scenario.law.first_follower!r} needs phases to follow")
        return (Phase("shape", duration or scenario.duration_s or 0.0),)
    phases, elapsed = [], 0.0
    for number, table in enumerate(scenario.phases, start=1):
        if table.displacement_m is None and not stationary:
            raise InputError(f"{path}: phases[{number}].displacement_m: missing")
        if table.displacement_m is not None and not any(table.displacement_m):
            raise InputError(f"{path}: phases[{number}].displacement_m: agents 1 and 2 must not be sent to one place")
        length = table.duration_s
        if duration is not None:
            last = number == len(scenario.phases)
            length = duration - elapsed if last else min(length, duration - elapsed)
        if length > 0.0:
            phases.append(Phase(table.name, length, table.velocity_m_s, table.displacement_m))
        elapsed += length
    return tuple(phases)
