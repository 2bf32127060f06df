"""The machines of a scenario: robots, floor, instruments, safety filter, and who tells whom the velocity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from formation import FormationLaw, Graph, VelocityEstimator, agents, needs
from formation.laws.another_pair import AnotherPairLaw
from formation.measurements import ANGLE, RATIO
from robots import GTERNAL, Arena, Fleet, Imperfections, Instruments, NearIdentityDiffeomorphism, RobotModel
from robots.obstacles import Obstacle
from robots.safety import FilterSettings
from scenarios.definition.schema import Scenario, SensorTable
from scenarios.errors import InputError, located


def arena(path: str, scenario: Scenario) -> Arena:
    """The floor with its walls and the obstacles that stand on it from the beginning."""
    obstacles = []
    for number, table in enumerate(scenario.obstacles, start=1):
        with located(path, f"obstacles[{number}]"):
            obstacles.append(Obstacle(np.array(table.vertices_m), table.radius_m))
    with located(path, "arena"):
        return Arena(scenario.arena.x_m, scenario.arena.y_m, scenario.arena.walls, tuple(obstacles))


def robot_model(scenario: Scenario) -> RobotModel:
    """The robot of which none differs."""
    table = scenario.robot
    return RobotModel(
        drive=replace(GTERNAL.drive, wheel_speed_limit=table.wheel_speed_limit_rad_s),
        chassis=replace(GTERNAL.chassis, tyre_friction=table.tyre_friction, body_friction=table.body_friction),
    )


def fleet(path: str, scenario: Scenario, nid: NearIdentityDiffeomorphism, robot: RobotModel, n: int) -> Fleet:
    """Every robot as its agent's table has it.

    Raises:
        InputError: robots of their own where all are measured, or share one filter.
    """
    own = {int(agents.rows(agent.id)): agent.robot for agent in scenario.agents if agent.robot is not None}
    if not own:
        return Fleet(robot.drive, nid, (robot.chassis,) * n)
    field = f"{path}: agents[id {agents.number(min(own))}].robot"
    if scenario.robot.model == "measured":
        raise InputError(f'{field}: measured robots have numbers of their own, expected robot.model = "nominal"')
    if scenario.safety.filter == "centralised":
        raise InputError(f"{field}: the centralised filter takes all robots for equal, expected another safety.filter")
    ahead, limits = np.full(n, nid.projection_distance), np.full(n, robot.drive.wheel_speed_limit)
    bodies = [robot.chassis] * n
    for row, table in own.items():
        ahead[row] = table.projection_distance_m or ahead[row]
        limits[row] = table.wheel_speed_limit_rad_s or limits[row]
        length, width = table.length_m or robot.chassis.length, table.width_m or robot.chassis.width
        bodies[row] = replace(robot.chassis, length=length, width=width)
    drive = replace(robot.drive, wheel_speed_limit=limits)
    return Fleet(drive, NearIdentityDiffeomorphism(ahead), tuple(bodies))


def filter_settings(path: str, scenario: Scenario) -> FilterSettings:
    """What the safety filter keeps and senses."""
    table = scenario.safety
    with located(path, "safety"):
        return FilterSettings(
            safe_distance=table.safe_distance_m,
            sensing_range=table.sensing_range_m,
            clearance=table.clearance_m,
            gain=table.gain_per_s,
            turn=table.turn_rad,
            stuck_time=table.stuck_time_s,
        )


def instruments(path: str, scenario: Scenario, law: FormationLaw, graph: Graph) -> Instruments:
    """What each robot measures: what the law declares, along the edges that it uses."""
    kinds = needs(law).measures
    edges = law.edges if isinstance(law, AnotherPairLaw) else graph.edges
    corners = graph.corners if {ANGLE, RATIO} & set(kinds) else ()
    with located(path, "law.measures"):
        return Instruments(edges, corners, kinds, imperfections(scenario.sensor))


def imperfections(table: SensorTable) -> Imperfections:
    """How bad the sensors are."""
    return Imperfections(
        position=table.position_noise_m,
        bearing=np.radians(table.bearing_noise_deg),
        distance=table.distance_noise_m,
        angle=np.radians(table.angle_noise_deg),
        ratio=table.ratio_noise,
        edge_loss=table.edge_loss,
        dropout=table.dropout,
    )


def estimator(path: str, scenario: Scenario, graph: Graph) -> VelocityEstimator | None:
    """How agents learn v_r from the leader; None where all are told."""
    if scenario.velocity_known_by == "all":
        return None
    table = scenario.communication
    edges = graph.edges if table.edges is None else agents.rows(table.edges)
    with located(path, "communication.edges"):
        return VelocityEstimator(graph.n, edges, table.gain_per_s)
