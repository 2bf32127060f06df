"""What the compiled period can do: a list of keys, so that one that is new to a scenario is never passed over."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from formation.laws.angle import AngleLaw
from scenarios.definition.experiment import Experiment

PLANTS = ("single_integrator", "unicycle", "saturated", "pymunk")

FILTERS = ("none", "decentralised")

MOST_TOGETHER = 64
"""Robots of a run up to which runs advance side by side; larger ones search for neighbours, each by itself."""

KNOWN = frozenset(
    {
        "title",
        "source",
        "duration_s",
        "agents.id",
        "agents.neighbours",
        "agents.start",
        "agents.heading_deg",
        "agents.gain",
        "agents.target",
        "agents.robot.projection_distance_m",
        "agents.robot.wheel_speed_limit_rad_s",
        "agents.robot.length_m",
        "agents.robot.width_m",
        "random_formation.agents",
        "random_formation.seed",
        "random_formation.radius_m",
        "random_formation.min_separation_m",
        "random_formation.min_angle_deg",
        "random_start.x_m",
        "random_start.y_m",
        "random_start.min_separation_m",
        "target.angles_deg",
        "graph",
        "leaders",
        "law.name",
        "law.first_follower",
        "law.settled_m",
        "law.gain",
        "law.feedforward",
        "law.activation",
        "phases.name",
        "phases.duration_s",
        "phases.velocity_m_s",
        "phases.displacement_m",
        "reference.kind",
        "reference.width_m",
        "reference.height_m",
        "reference.period_s",
        "reference.speed_m_s",
        "reference.direction_deg",
        "reference.clockwise",
        "reference.orientation",
        "reference.displacement_m",
        "reference.points.t_s",
        "reference.points.position_m",
        "reference.points.scale",
        "reference.points.turn_deg",
        "reference.velocities.t_s",
        "reference.velocities.velocity_m_s",
        "reference.velocities.scale",
        "reference.velocities.turn_deg",
        "reference.file",
        "reference.function",
        "reference.ends",
        "velocity_known_by",
        "communication.edges",
        "communication.gain_per_s",
        "robot.projection_distance_m",
        "robot.saturation",
        "robot.wheel_speed_limit_rad_s",
        "robot.tyre_friction",
        "robot.body_friction",
        "arena.x_m",
        "arena.y_m",
        "arena.walls",
        "plant.name",
        "plant.control_period_s",
        "safety.filter",
        "safety.safe_distance_m",
        "safety.sensing_range_m",
        "safety.clearance_m",
        "safety.gain_per_s",
        "safety.turn_rad",
        "safety.stuck_time_s",
        "obstacles.vertices_m",
        "obstacles.radius_m",
        "goal.angle_error_sum_rad",
        "goal.accepted",
        "goal.distance_m",
        "sensor.position_noise_m",
        "sensor.bearing_noise_deg",
        "sensor.delay_periods",
        "sensor.own_motion",
    }
)
"""Keys that the compiled period honours, or that it need not know: starts, targets, goals."""

WHOLE = frozenset({"target.angles_deg", "communication.edges"})
"""Keys whose values are no tables of the schema."""


def side_by_side(experiment: Experiment) -> bool:
    """Whether its runs advance side by side."""
    return experiment.plant != "pymunk" and experiment.n <= MOST_TOGETHER


def unable(experiment: Experiment) -> str | None:
    """Why an experiment has to be stepped by Python: the first thing that is not compiled; None where all is."""
    scenario = experiment.scenario
    if type(experiment.law) is not AngleLaw or experiment.aim.target is None:
        return f"law.name = {scenario.law.name!r}"
    if experiment.plant not in PLANTS:
        return f"plant.name = {experiment.plant!r}"
    if experiment.safety not in FILTERS:
        return f"safety.filter = {experiment.safety!r}"
    changed = scenario.model_dump(exclude_defaults=True)
    return next((key for key in _keys(changed) if key not in KNOWN), None)


def _keys(table: Mapping[str, Any], above: str = "") -> Iterator[str]:
    """The keys of nested tables, dotted; a list of tables has those of each."""
    for name, value in table.items():
        key = above + name
        if isinstance(value, Mapping) and key not in WHOLE:
            yield from _keys(value, f"{key}.")
        elif isinstance(value, tuple | list) and value and all(isinstance(part, Mapping) for part in value):
            for part in value:
                yield from _keys(part, f"{key}.")
        else:
            yield key
