"""The scenario file: every table and key, its unit, its default and what it may be.

A scenario is TOML. Units are part of the names. Unknown keys are refused.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
AgentNumber = Annotated[int, Field(strict=True, ge=1)]
Flag = Annotated[bool, Field(strict=True)]
Vector = tuple[Number, Number]


class Table(BaseModel):
    """A table of the file: no unknown keys, no change after validation."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class AgentTable(Table):
    """One agent."""

    id: AgentNumber
    neighbours: tuple[AgentNumber, ...] = ()
    """Numbers of the agents that it senses: none for 1, [1] for 2, two smaller numbers for all others."""
    start: Vector | None = None
    """Initial position of its projected point, m."""
    heading_deg: Number | None = None
    """Initial heading; drawn from the run's seed where absent."""
    target: Vector | None = None
    """Its place in one configuration that has the desired shape, m."""


class TargetTable(Table):
    """The shape, besides the agents' target positions."""

    angles_deg: dict[str, Number] = Field(default_factory=dict)
    """Angles that are measured and compared, named "vertex;from,to", counter-clockwise. Where the agents have target
    positions, each must agree with them within half a unit of its second decimal."""


class PhaseTable(Table):
    """One phase of a maneuver."""

    name: str
    duration_s: Positive
    velocity_m_s: Vector = (0.0, 0.0)
    """v_r, in the common frame."""
    displacement_m: Vector | None = None
    """delta_12 = p_2 - p_1 that the first follower is told, in the common frame."""


class LawTable(Table):
    """The formation law."""

    first_follower: Literal["stationary", "displacement", "distance", "bearing"] = "stationary"


class RobotTable(Table):
    """The robot; defaults are the Robotarium's GTernal."""

    projection_distance_m: Positive = 0.025
    """l, from the axle's centre ahead to the point that the law steers."""
    saturation: Literal["scale", "clip"] = "scale"
    """At the wheels' limit: slow both wheels by one factor, or cut each by itself."""
    wheel_speed_limit_rad_s: Positive = 12.5
    tyre_friction: NotNegative = 0.8
    body_friction: NotNegative = 0.0


class ArenaTable(Table):
    """The floor that the testbed grants."""

    x_m: Vector = (-1.6, 1.6)
    y_m: Vector = (-1.0, 1.0)
    walls: Flag = False
    """Whether the floor's sides stop a chassis."""


class PlantTable(Table):
    """The world of the run."""

    name: Literal["single_integrator", "unicycle", "saturated", "pymunk"] = "pymunk"
    control_period_s: Positive = 0.033
    """Stretched by less than half a period per phase, so that a whole number of periods fits each phase."""


class SensorTable(Table):
    """Noise of the relative position measurements."""

    position_noise_m: NotNegative = 0.0
    bearing_noise_deg: NotNegative = 0.0


class GoalTable(Table):
    """When a run has reached its goal."""

    angle_error_sum_rad: Positive = 0.01
    """Bound on the sum of the absolute angle errors of the projected points."""


class Scenario(Table):
    """A whole scenario file."""

    title: str
    source: str = ""
    """Where the experiment comes from."""
    duration_s: Positive | None = None
    """Length of the run; absent where phases are given."""
    agents: Annotated[tuple[AgentTable, ...], Field(min_length=3)]
    target: TargetTable = TargetTable()
    law: LawTable = LawTable()
    phases: tuple[PhaseTable, ...] = ()
    robot: RobotTable = RobotTable()
    arena: ArenaTable = ArenaTable()
    plant: PlantTable = PlantTable()
    sensor: SensorTable = SensorTable()
    goal: GoalTable = GoalTable()
