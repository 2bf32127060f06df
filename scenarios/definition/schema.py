"""The scenario file: every table and key, its unit, its default and what it may be.

A scenario is TOML. Units are part of the names. Unknown keys are refused.
"""

# Longer than 300 lines: a scenario file has one schema, with all its tables.

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from scenarios.definition.bounds import (
    LARGEST,
    LARGEST_INTEGER,
    LONGEST_RUN,
    MOST_AGENTS,
    MOST_EVENTS,
    MOST_OBSTACLES,
    SMALLEST,
)
from scenarios.definition.files.library import DEFAULT_PLANT

Number = Annotated[float, Field(strict=True, ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, ge=SMALLEST, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0.0, le=LARGEST, allow_inf_nan=False)]
Probability = Annotated[float, Field(strict=True, ge=0.0, le=1.0, allow_inf_nan=False)]
FieldOfView = Annotated[float, Field(strict=True, ge=SMALLEST, le=360.0, allow_inf_nan=False)]
AgentNumber = Annotated[int, Field(strict=True, ge=1, le=MOST_AGENTS)]
Flag = Annotated[bool, Field(strict=True)]
Vector = tuple[Number, Number]
Line = Annotated[str, Field(pattern=r"^\P{Cc}*$")]


class Table(BaseModel):
    """A table of the file: no unknown keys, no change after validation."""

    # What the keys mean stands in their docstrings; `scenarios.definition.keys` reads them when asked. Were they
    # pydantic's, every command would parse this file for each of its tables. Deferred, tables are built once, as parts
    # of a whole.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class OwnRobotTable(Table):
    """A robot that differs from `robot`; what is absent is as there, and the chassis as the GTernal's."""

    projection_distance_m: Positive | None = None
    """l of this robot."""
    wheel_speed_limit_rad_s: Positive | None = None
    """Of its wheels."""
    length_m: Positive | None = None
    """Of its chassis, along the heading."""
    width_m: Positive | None = None
    """Of its chassis, across the heading."""


class AgentTable(Table):
    """One agent."""

    id: AgentNumber
    """Its number: 1 is the leader, 2 the first follower."""
    neighbours: tuple[AgentNumber, ...] = ()
    """Numbers of the agents that it senses: none for 1, [1] for 2, two smaller numbers for all others; as the law
    needs for a law with another graph."""
    start: Vector | None = None
    """Initial position of its projected point, m."""
    heading_deg: Number | None = None
    """Initial heading; drawn from the run's seed where absent."""
    robot: OwnRobotTable | None = None
    gain: Positive | None = None
    """Of a follower of the angle law, on top of eq. (u): it decays at gain times sin^2 of its angle, 1/s; as `law.gain`
    says where absent."""
    target: Vector | None = None
    """Its place in one configuration that has the desired shape, m; given for all agents, or for none and then the
    shape is defined by `target.angles_deg`."""


class TargetTable(Table):
    """The shape, besides the agents' target positions."""

    angles_deg: dict[str, Number] = Field(default_factory=dict)
    """Angles that are measured and compared, named "vertex;from,to", counter-clockwise. Where the agents have target
    positions, each must agree with them within half a unit of its second decimal; where they have none, two angles of
    each follower's triangle define the shape."""


class PhaseTable(Table):
    """One phase of a maneuver."""

    name: Line
    """What a person calls it."""
    duration_s: Positive
    """Its length."""
    velocity_m_s: Vector = (0.0, 0.0)
    """v_r, in the common frame."""
    displacement_m: Vector | None = None
    """delta_12 = p_2 - p_1 that the first follower is told, in the common frame."""


class WayPointTable(Table):
    """A place that the leader passes at a time."""

    t_s: NotNegative
    """Seconds since the start; the first is 0, and they increase."""
    position_m: Vector
    """Of the leader; differences from the first count, as the leader begins where it starts."""
    scale: Positive = 1.0
    """Of the formation, relative to the first."""
    turn_deg: Number = 0.0
    """Of the formation, counter-clockwise, not wrapped; differences from the first count."""


class RampTable(Table):
    """What the leader and the formation are told at a time."""

    t_s: NotNegative
    """Seconds since the start; the first is 0, and they increase."""
    velocity_m_s: Vector = (0.0, 0.0)
    """v_r then, in the common frame."""
    scale: Positive = 1.0
    """Of the formation, relative to the first."""
    turn_deg: Number = 0.0
    """Of the formation, counter-clockwise, not wrapped; differences from the first count."""


class ReferenceTable(Table):
    """A motion that changes all the time, in the place of phases: a closed curve, way-points or ramps."""

    kind: Literal["circle", "ellipse", "figure-eight", "way-points", "ramps"]
    """The leader's path. Way-points are joined by cubic splines, twice continuously differentiable, at rest at both
    ends. Ramps are velocities, scales and turns at times, joined by straight lines; the last ones are kept."""
    width_m: Positive | None = None
    """Of a closed curve, along `direction_deg`; the diameter of a circle."""
    height_m: Positive | None = None
    """Of an ellipse or a figure eight, across it."""
    period_s: Positive | None = None
    """Of one round; or give the speed."""
    speed_m_s: Positive | None = None
    """Mean speed of the leader on a closed curve; a circle's is constant."""
    direction_deg: Number = 0.0
    """Of a closed curve's width; circle and ellipse begin that way, a figure eight in its crossing."""
    clockwise: Flag = False
    """Whether a closed curve bends to the right first."""
    orientation: Literal["along-path", "kept"] = "along-path"
    """Whether the formation turns as a closed curve does, or keeps its orientation."""
    displacement_m: Vector | None = None
    """delta_12 at the start, in the common frame; the target's where absent."""
    points: Annotated[tuple[WayPointTable, ...], Field(max_length=LONGEST_RUN)] = ()
    """Way-points."""
    velocities: Annotated[tuple[RampTable, ...], Field(max_length=LONGEST_RUN)] = ()
    """Of ramps."""
    file: str | None = None
    """In the place of way-points, a comma-separated file with the columns t_s, x_m, y_m and, if you like, scale and
    turn_deg, or a Python file, executed: read when the scenario is; its path starts where the scenario file is."""
    function: str | None = None
    """Name of a function in the Python file that returns (x_m, y_m) or (x_m, y_m, scale, turn_deg) at t seconds; asked
    ten times a second, it becomes way-points."""
    ends: Literal["at-rest", "moving"] = "at-rest"
    """Whether a way through way-points begins and ends at rest, or in the motion that they suggest; a function's is
    moving where absent."""


class LawTable(Table):
    """The formation law."""

    name: Literal[
        "angle",
        "displacement",
        "displacement-undirected",
        "bearing",
        "bearing-undirected",
        "distance",
        "distance-undirected",
        "ratio",
        "redundant",
        "area",
        "area-undirected",
        "persistent",
        "cosine",
        "triangular",
        "bisector",
        "laplacian",
        "affine",
        "affine-undirected",
        "triangle-angles",
        "triangle-mixed",
        "own",
    ] = "angle"
    """The paper's law, one of those that it weighs itself against (docs/laws.md), or an own law, whose file is
    executed."""
    first_follower: Literal["stationary", "displacement", "distance", "bearing", "spiral"] = "stationary"
    """What the first follower of the angle law does with the phases' displacement. "spiral" reaches it as
    "displacement" does, but around the leader where that leads through it, so that the formation turns and does not
    shrink."""
    gain: Literal["paper", "normalised"] = "paper"
    """Of all followers of the angle law: 1, eq. (u) as the paper has it, or 1 / sin^2, which makes all rates 1 per
    second; `show` tells its price in noise."""
    feedforward: Flag = False
    """Whether agents are told mu = delta'/delta, how the formation scales and turns, so that the angle law follows
    without lag; needs no compass."""
    activation: Literal["simultaneous", "sequential"] = "simultaneous"
    """Whether each follower waits until its neighbours have settled (Lemma 3)."""
    settled_m: Positive = 0.005
    """Distance from its place below which a follower counts as settled, for sequential activation."""
    without_neighbour: Literal["hold-still", "keep-last", "another-pair"] = "hold-still"
    """What a robot does whose law lacks a measurement: it holds still, keeps its last command, or, a follower of the
    angle law, takes another pair of agents before it that it senses."""
    file: str | None = None
    """Python file of an own law; its path starts where the scenario file is."""
    factory: str | None = None
    """Function or class in that file, called once as `factory(target, **parameters)`; docs/own-law.md says more."""
    parameters: dict[str, Number] = Field(default_factory=dict)
    """What the factory is called with, by name; or a built-in law's own gains, those of docs/laws.md."""


class CommunicationTable(Table):
    """How agents learn v_r when only the leader knows it."""

    edges: tuple[tuple[AgentNumber, AgentNumber], ...] | None = None
    """(receiver, sender) pairs; each agent hears those that it senses where absent."""
    gain_per_s: Positive = 2.0
    """Rate at which an agent moves its estimate to the mean of those that it hears."""
    message_loss: Probability = 0.0
    """Probability that a message is lost, each by itself in each control period; who hears nobody keeps its
    estimate."""


class RobotTable(Table):
    """The robot; defaults are the Robotarium's GTernal."""

    projection_distance_m: Positive = 0.025
    """l, from the axle's centre ahead to the point that the law steers."""
    saturation: Literal["scale", "clip"] = "scale"
    """At the wheels' limit: slow both wheels by one factor, or cut each by itself."""
    wheel_speed_limit_rad_s: Positive = 12.5
    """Of either wheel, in both directions."""
    tyre_friction: NotNegative = 0.8
    """Coefficient between tyres and floor: the force of all tyres is at most this times the weight."""
    body_friction: NotNegative = 0.0
    """Coefficient between two chassis, and a chassis and a wall."""
    model: Literal["nominal", "measured"] = "nominal"
    """The data sheet's robot, or the one that logs and firmware show, on the plants `saturated` and `pymunk`;
    docs/testbed.md says what it has."""
    file: str | None = None
    """Robot file that `formation identify` wrote, for the measured robot; its path starts where the scenario file is,
    or where the command runs."""
    numbers: dict[str, Number] | None = None
    """The content of that file, in its place: what a run folder keeps."""
    base_spread: Annotated[float, Field(strict=True, ge=0.0, le=0.2)] = 0.01
    """Relative deviation of the measured robots' base lengths from one to the next; assumed."""
    radius_spread: Annotated[float, Field(strict=True, ge=0.0, le=0.2)] = 0.005
    """Relative deviation of their wheel radii; assumed."""


class ArenaTable(Table):
    """The floor that the testbed grants."""

    x_m: Vector = (-1.6, 1.6)
    """[low, high] of the floor."""
    y_m: Vector = (-1.0, 1.0)
    """[low, high] of the floor."""
    walls: Flag = False
    """Whether the floor's sides stop a chassis."""


class PlantTable(Table):
    """The world of the run."""

    name: Literal["single_integrator", "unicycle", "saturated", "pymunk"] = DEFAULT_PLANT
    """From the theorem's points to bodies with mass; `--plant` replaces it."""
    control_period_s: Positive = 0.033
    """Stretched or shortened so that a whole number of periods, at least one, fills each phase."""


class SensorTable(Table):
    """Errors of what the robots measure."""

    position_noise_m: NotNegative = 0.0
    """Standard deviation of each coordinate of a measured relative position, drawn each control period."""
    bearing_noise_deg: NotNegative = 0.0
    """Standard deviation of a rotation of a measurement about its observer, drawn each control period."""
    distance_noise_m: NotNegative = 0.0
    """Standard deviation of a measured distance, for laws that measure distances."""
    angle_noise_deg: NotNegative = 0.0
    """Standard deviation of a measured angle between two neighbours, for laws that measure angles."""
    ratio_noise: NotNegative = 0.0
    """Standard deviation of a measured ratio of distances, as a fraction of it, for laws that measure ratios."""
    edge_loss: Probability = 0.0
    """Probability that an edge gives no measurement during a control period, each by itself; what a robot does whose
    law needs it says `law.without_neighbour`."""
    dropout: Probability = 0.0
    """Probability that a robot measures nothing during a control period."""
    sensing_range_m: Positive | None = None
    """How far from its own projected point a robot measures those of others; any distance where absent."""
    field_of_view_deg: FieldOfView | None = None
    """Angle, half on either side of straight ahead, in which a robot measures others; all around where absent."""
    compass_bias_deg: NotNegative = 0.0
    """Standard deviation of each robot's constant compass error."""
    delay_periods: Annotated[int, Field(strict=True, ge=0, le=LONGEST_RUN)] = 0
    """Control periods by which all measurements lag."""
    own_motion: Literal["measured", "turn", "unknown"] = "measured"
    """What a robot knows of its own motion since a measurement was taken, and undoes before it uses it: turn and
    displacement (gyro and encoders), its turn, or nothing."""
    gyro_noise_deg_s: NotNegative = 0.0
    """Standard deviation of a robot's turning speed as it measures it, drawn each control period; for delays alone."""
    encoder_noise_m_s: NotNegative = 0.0
    """Standard deviation of each coordinate of its velocity as its encoders have it; likewise."""


class SafetyTable(Table):
    """What keeps the robots apart; docs/safety.md derives it."""

    filter: Literal["none", "decentralised", "centralised", "robotarium"] = "none"
    """`robotarium` has the defaults of the public simulator's certificate and none of the keys below."""
    safe_distance_m: Positive = 0.155
    """Ds, between the projected points of two robots."""
    sensing_range_m: Positive = 0.30
    """How far a robot sees others; rows are written for what is nearer."""
    clearance_m: Positive = 0.08
    """Between a projected point and a wall or an obstacle."""
    gain_per_s: Positive = 5.0
    """gamma: how fast the remaining distance may shrink."""
    turn_rad: NotNegative = 0.7
    """How far a robot turns its law to the left before a robot, wall or obstacle ahead."""
    stuck_time_s: Positive = 2.0
    """Time without progress after which a deadlock is declared and broken."""


class ObstacleTable(Table):
    """Everything within a radius of a point, of a segment or of a convex polygon: a disc, a bar, a block."""

    vertices_m: Annotated[tuple[Vector, ...], Field(min_length=1, max_length=MOST_OBSTACLES)]
    """One vertex, two, or those of a convex polygon in order."""
    radius_m: NotNegative = 0.0
    """How far the obstacle reaches beyond its vertices, edges or faces."""


class EventTable(Table):
    """Something that happens on the way; docs/events.md says which keys belong to which kind."""

    t_s: NotNegative
    """Seconds since the start of the run: when it happens."""
    kind: Literal["stop", "push", "dropout", "edge-loss", "sensor", "message-loss", "reshape", "obstacle"]
    """A robot stops; it is pushed; no other robot senses it; one edge is lost; sensors get worse, or better; messages
    are lost; the target shape changes; an obstacle appears."""
    until_s: Positive | None = None
    """When it is over; never where absent. A push and a reshape are over at once."""
    agent: AgentNumber | None = None
    """Who stops, is pushed or drops out."""
    edge: tuple[AgentNumber, AgentNumber] | None = None
    """[observer, observed] of the edge that is lost."""
    displacement_m: Vector | None = None
    """How far a push moves a robot that its tyres alone would stop: the plants without mass move it there at once,
    `pymunk` gives it the impulse after which it slides so far, about."""
    sensing_range_m: Positive | None = None
    """In the place of `sensor.sensing_range_m`."""
    field_of_view_deg: FieldOfView | None = None
    """In the place of `sensor.field_of_view_deg`."""
    edge_loss: Probability | None = None
    """In the place of `sensor.edge_loss`."""
    dropout: Probability | None = None
    """In the place of `sensor.dropout`."""
    message_loss: Probability | None = None
    """In the place of `communication.message_loss`."""
    name: Line | None = None
    """What a person calls the part of the run that a reshape begins."""
    target_m: Annotated[tuple[Vector, ...], Field(max_length=MOST_AGENTS)] | None = None
    """Places of the agents 1, 2, ... in one configuration of the new shape."""
    neighbours: Annotated[tuple[tuple[AgentNumber, ...], ...], Field(max_length=MOST_AGENTS)] | None = None
    """Whom the agents 1, 2, ... sense from then on; those of before where absent."""
    vertices_m: Annotated[tuple[Vector, ...], Field(min_length=1, max_length=MOST_OBSTACLES)] | None = None
    """Of an obstacle, as in `obstacles`."""
    radius_m: NotNegative | None = None
    """Of an obstacle, as in `obstacles`."""


class RandomStartTable(Table):
    """Initial projected points drawn uniformly from a rectangle, by the run's seed."""

    x_m: Vector = (-1.4, 1.4)
    """[low, high] of the rectangle."""
    y_m: Vector = (-0.8, 0.8)
    """[low, high] of the rectangle."""
    min_separation_m: NotNegative = 0.2
    """Smallest distance between two starts."""


class RandomFormationTable(Table):
    """A random leader-first-follower graph and target, in place of `agents`. Starts need `random_start`."""

    agents: Annotated[int, Field(strict=True, ge=3, le=MOST_AGENTS)]
    """How many."""
    seed: Annotated[int, Field(strict=True, ge=0, le=LARGEST_INTEGER)]
    """Of graph and target; not the run's seed."""
    radius_m: Positive = 1.0
    """Of the disc that holds the target."""
    min_separation_m: NotNegative = 0.0
    """Smallest distance between two agents of the target."""
    min_angle_deg: Annotated[float, Field(strict=True, ge=SMALLEST, lt=60.0)] = 15.0
    """Every interior angle stays this far from a degenerate triangle."""


class GoalTable(Table):
    """When a run has reached its goal."""

    angle_error_sum_rad: Positive = 0.01
    """Bound on the sum of the absolute angle errors of the projected points; where sensors are noisy, of the means of
    the signed errors over the last 10 s."""
    accepted: Flag = False
    """Whether the testbed has to accept the run besides."""
    distance_m: Positive | None = None
    """Bound besides on how far any agent may be from its place on the predicted way, from when all first keep it to the
    end: what a gap holds up has missed it, though it catches up."""


class Scenario(Table):
    """A whole scenario file."""

    title: Line
    """One line that `formation list` shows."""
    source: Annotated[str, Field(pattern=r"^[\P{Cc}\n]*$")] = ""
    """Where the experiment comes from."""
    duration_s: Positive | None = None
    """Length of the run; absent where phases are given."""
    agents: Annotated[tuple[AgentTable, ...], Field(max_length=MOST_AGENTS)] = ()
    """At least three, with the numbers 1..n, unless `random_formation` is given."""
    random_formation: RandomFormationTable | None = None
    random_start: RandomStartTable | None = None
    """In place of the agents' own `start`."""
    target: TargetTable = TargetTable()
    graph: Literal["given", "subgraph", "design"] = "given"
    """Who senses whom: as the agents' neighbours say; the leader-first-follower graph inside what they say, for any
    numbering and with edges to spare; or the kind that the law needs, built from the target."""
    leaders: tuple[AgentNumber, AgentNumber] | None = None
    """Numbers of the leader and of the first follower where the graph is not given; 1 and 2 where absent."""
    law: LawTable = LawTable()
    phases: Annotated[tuple[PhaseTable, ...], Field(max_length=LONGEST_RUN)] = ()
    reference: ReferenceTable | None = None
    velocity_known_by: Literal["all", "leader"] = "all"
    """Whether v_r is broadcast, or known to the leader alone and spread over the communication graph."""
    communication: CommunicationTable = CommunicationTable()
    robot: RobotTable = RobotTable()
    arena: ArenaTable = ArenaTable()
    plant: PlantTable = PlantTable()
    sensor: SensorTable = SensorTable()
    safety: SafetyTable = SafetyTable()
    obstacles: Annotated[tuple[ObstacleTable, ...], Field(max_length=MOST_OBSTACLES)] = ()
    events: Annotated[tuple[EventTable, ...], Field(max_length=MOST_EVENTS)] = ()
    goal: GoalTable = GoalTable()
