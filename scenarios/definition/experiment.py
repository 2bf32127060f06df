"""From a validated scenario to the objects of the theory and of the machines."""

# Longer than 300 lines: every part of an experiment is made here, from one scenario, in one order.

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formation import (
    LAWS,
    AngleLaw,
    AngleSet,
    FormationLaw,
    Framework,
    Graph,
    Phase,
    TargetFormation,
    VelocityEstimator,
    agents,
    decay_rates,
    needs,
)
from formation.laws.another_pair import AnotherPairLaw
from formation.laws.base import ORIENTATION, SCALE
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from formation.measurements import ANGLE, RATIO
from robots import GTERNAL, Arena, Fleet, Imperfections, Instruments, NearIdentityDiffeomorphism, RobotModel
from robots.measured import MeasuredModel
from robots.obstacles import Obstacle
from robots.safety import FilterSettings
from scenarios.definition.bounds import LONGEST_RUN, check_size
from scenarios.definition.choice import chosen
from scenarios.definition.events.build import build_events, check_front
from scenarios.definition.events.event import RESHAPE, Event
from scenarios.definition.events.reshape import cut, reshaped
from scenarios.definition.files import robot_file
from scenarios.definition.formations import Aim, build_aim
from scenarios.definition.load import ScenarioFile, load
from scenarios.definition.own_law import NotLoaded, OwnFactory, check_parameters, condition
from scenarios.definition.references import build_reference
from scenarios.definition.schema import LawTable, Scenario, SensorTable
from scenarios.definition.starts import Starts, build_starts
from scenarios.definition.targets import in_order
from scenarios.errors import InputError, located

Real = NDArray[np.float64]

FIRST_FOLLOWERS = {
    frozenset[str](): "stationary",
    frozenset({SCALE}): "distance",
    frozenset({ORIENTATION}): "bearing",
    frozenset({SCALE, ORIENTATION}): "displacement",
}
"""How agent 2 moves in the end, a name of :data:`formation.EDGE_LAWS`, by what of delta a law follows."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """Everything that a run needs, ready to use.

    Attributes:
        file: the scenario with its origin.
        numbers: of the agents as the file has them, row by row; 1..n but for a graph that is not given.
        aim: the formation that the law is made for, and the angles that are compared.
        starts: the initial state, as far as the scenario fixes it.
        phases: the maneuver, a single phase for shape control.
        law: the formation law.
        own_gains: (n - 2,) gain of each follower of the angle law on top of eq. (u); None where all are 1.
        estimator: how agents learn v_r; None where it is broadcast.
        measured: the robots as logs and firmware show them; None for the data sheet's.
        fleet: the robots, each as it is; ``nid`` and ``robot`` are those of which none differs.
        asked_duration: seconds that replaced the scenario's own; None where none did.
        events: what happens on the way, by time.
        shapes: of each phase, the experiment with that phase's aim and law; empty where the shape never changes.
    """

    file: ScenarioFile
    numbers: tuple[int, ...]
    aim: Aim
    starts: Starts
    phases: tuple[Phase, ...]
    law: FormationLaw
    own_gains: Real | None
    estimator: VelocityEstimator | None
    instruments: Instruments
    nid: NearIdentityDiffeomorphism
    robot: RobotModel
    arena: Arena
    filter_settings: FilterSettings
    measured: MeasuredModel | None
    fleet: Fleet
    asked_duration: float | None = None
    events: tuple[Event, ...] = ()
    shapes: tuple[Experiment, ...] = ()

    @property
    def scenario(self) -> Scenario:
        return self.file.scenario

    @property
    def plant(self) -> str:
        return self.scenario.plant.name

    @property
    def safety(self) -> str:
        """The safety filter, a name of :data:`robots.safety.FILTERS`.

        The single integrator is the theorem's model: points, which neither have wheels nor collide.
        """
        return "none" if self.plant == "single_integrator" else self.scenario.safety.filter

    @property
    def formation(self) -> Framework:
        """The target's shape on the graph along which the law measures."""
        return self.aim.formation

    @property
    def graph(self) -> Graph:
        """Who senses whom."""
        return self.formation.graph

    @property
    def target(self) -> TargetFormation:
        """The target on the leader-first-follower graph that the paper's theory speaks of.

        Raises:
            InputError: the scenario's graph is of another kind.
        """
        if self.aim.target is None:
            raise InputError(f"{self.file.path}: agents: expected a leader-first-follower graph")
        return self.aim.target

    @property
    def angles(self) -> AngleSet:
        """The angles that are measured and compared."""
        return self.aim.angles

    @property
    def target_angles(self) -> Real:
        """(m,) the angles' targets, radians, exact."""
        return self.aim.target_angles

    def of_phase(self, index: int) -> Experiment:
        """The experiment with the aim and the law of a phase, which are its own where the shape never changes."""
        return self.shapes[index] if self.shapes else self

    def targets(self, phase: NDArray[np.intp]) -> Real:
        """The angles' targets, radians: (m,), or (T, m) of states in the phases (T,) where the shape changes."""
        if not self.shapes:
            return self.target_angles
        return np.stack([each.target_angles for each in self.shapes])[phase]

    @property
    def n(self) -> int:
        """Number of agents."""
        return self.graph.n

    def number(self, row: int) -> int:
        """The number by which people know the agent in a row."""
        return self.numbers[row]

    def numbered(self, rows: ArrayLike) -> NDArray[np.intp]:
        """The numbers of agents given by row, same shape."""
        return np.array(self.numbers, dtype=np.intp)[np.asarray(rows, dtype=np.intp)]

    def name(self, row: int) -> str:
        """How messages, tables and recordings name the agent in a row: ``"agent 3"``."""
        return f"agent {self.number(row)}"

    @cached_property
    def angle_names(self) -> list[str]:
        """How each angle is written: ``"alpha(3;2,4)"``, agents by number."""
        return [f"alpha({v};{a},{b})" for v, a, b in self.numbered(self.angles.triples).tolist()]

    @property
    def goal(self) -> float:
        """Bound on the sum of the absolute angle errors, radians."""
        return self.scenario.goal.angle_error_sum_rad

    @property
    def noisy(self) -> bool:
        """Whether measurements or motion are drawn anew each period: a run is judged over a while, not by its end."""
        sensor = self.scenario.sensor
        return sensor.position_noise_m > 0.0 or sensor.bearing_noise_deg > 0.0 or self.measured is not None

    @cached_property
    def first_follower(self) -> str:
        """The edge law by which agent 2 acts, a name of :data:`formation.EDGE_LAWS`.

        Of an own law, the one that keeps or reaches the commanded displacement: what a reference for it is drawn from.
        """
        law = self.scenario.law
        if law.name == "angle":
            return law.first_follower
        return "displacement" if law.name == "own" else FIRST_FOLLOWERS[LAWS[law.name].steers]

    @property
    def predicted(self) -> bool:
        """Whether the theory says where the run ends: of laws with a leader and a first follower, not of an own law."""
        return self.scenario.law.name != "own" and LAWS[self.scenario.law.name].leaders in (1, 2)

    def initial_points(self, seed: int) -> Real:
        """(n, 2) initial projected points of the run with that seed, metres."""
        return self.starts.draw(np.random.default_rng(seed))[0]


def open_experiment(scenario: str | Path, changes: tuple[str, ...] = (), duration: float | None = None) -> Experiment:
    """The experiment of a scenario's name or path, with ``--set`` changes and a shortened or lengthened run.

    Raises:
        InputError: anything in the scenario that cannot be used, with file and field.
    """
    return build(load(str(scenario), changes), duration)


def require_safety(experiment: Experiment, safety: str | None) -> None:
    """Refuse a filter that was asked for on a plant that has nothing to filter; None asks for nothing.

    Raises:
        InputError: the experiment runs without it.
    """
    if safety is not None and safety != experiment.safety:
        raise InputError(f"--safety {safety}: the plant {experiment.plant} has no robots to keep apart, expected none")


def build(file: ScenarioFile, duration: float | None = None, to_run: bool = True) -> Experiment:
    """The experiment of a scenario file.

    Args:
        file: the scenario.
        duration: seconds; replaces the scenario's own.
        to_run: False where a run is only looked at, and then the file of an own law is not executed.

    Raises:
        InputError: anything in the scenario that cannot be used, with file and field.
    """
    path = file.path
    needed = _needed(file)
    scenario, numbers = chosen(path, file.scenario, needed)
    if duration is not None and not (np.isfinite(duration) and duration > 0.0):
        raise InputError(f"--duration: expected a positive number of seconds, got {duration:g}")
    check_size(path, scenario, duration)
    aim = build_aim(path, scenario, needed)
    with located(path, "robot"):
        robot = _robot(scenario)
        nid = NearIdentityDiffeomorphism(scenario.robot.projection_distance_m)
    if scenario.sensor.delay_periods and scenario.plant.name == "single_integrator":
        raise InputError(f"{path}: sensor.delay_periods: the plant single_integrator is continuous, expected 0")
    if scenario.law.name == "angle" and aim.target is not None:
        _check_rates(path, aim.target, scenario.plant.control_period_s)
    if scenario.law.feedforward:
        _check_feedforward(path, scenario, aim)
    if scenario.sensor.field_of_view_deg is not None:
        check_front(f"{path}: sensor.field_of_view_deg", scenario)
    arena = _arena(path, scenario)
    whom = numbers or tuple(range(1, aim.formation.graph.n + 1))
    events = build_events(path, scenario, whom, aim.formation.graph)
    phases, shapes = cut(_phases(path, scenario, aim.formation, duration), events)
    own_gains = _own_gains(path, scenario, aim)
    law = _law(file, aim, phases, to_run, own_gains)
    if scenario.law.activation == "sequential" and aim.formation is not aim.target:
        raise InputError(f"{path}: law.activation: 'sequential' needs a leader-first-follower graph")
    experiment = Experiment(
        file=file,
        numbers=whom,
        aim=aim,
        starts=build_starts(path, scenario, aim.formation, arena),
        phases=phases,
        law=law,
        own_gains=own_gains,
        estimator=_estimator(path, scenario, aim.formation.graph),
        instruments=_instruments(path, scenario, law, aim.formation.graph),
        nid=nid,
        robot=robot,
        arena=replace(arena, obstacles=(*arena.obstacles, *(each.obstacle for each in events if each.obstacle))),
        filter_settings=_filter_settings(path, scenario),
        measured=robot_file.measured(scenario, path),
        fleet=_fleet(path, scenario, nid, robot, aim.formation.graph.n),
        asked_duration=duration,
        events=events,
    )
    return experiment if not any(shapes) else replace(experiment, shapes=_shapes(experiment, shapes, to_run))


def _shapes(first: Experiment, shapes: tuple[int, ...], to_run: bool) -> tuple[Experiment, ...]:
    """Of each phase, the experiment with the aim and the law of the shape that it has, by the number of changes.

    The angles that are compared stay those of the first shape; their targets change.
    """
    path, made = first.file.path, [first]
    scenario = first.scenario
    for event in (event for event in first.events if event.kind == RESHAPE):
        scenario = reshaped(scenario, event.table)
        label = replace(first.file, path=f"{path}: events[{event.number}]", scenario=scenario)
        new = build(label, first.asked_duration, to_run)
        aim = replace(new.aim, angles=first.angles, target_angles=first.angles.measure(new.formation.positions))
        made.append(replace(first, aim=aim, law=new.law, own_gains=new.own_gains, instruments=new.instruments))
    return tuple(made[count] for count in shapes)


def _check_rates(path: str, target: TargetFormation, control_period: float) -> None:
    """Refuse a follower so slow (rate sin^2 of its angle, Theorem 1) that the longest run there can be is too short."""
    rates, longest = decay_rates(target), LONGEST_RUN * control_period
    slowest = int(rates.argmin())
    if rates[slowest] * longest < 1.0:
        i, j, k = agents.numbers(target.graph.triangles[slowest])
        raise InputError(
            f"{path}: agents: Assumption 2: agent {k} is all but collinear with its neighbours {i} and {j}, |sin| = "
            f"{abs(np.sin(target.follower_angles[slowest])):.2g}: at {rates[slowest]:.2g} 1/s it cannot settle within "
            f"the longest run, {longest:g} s"
        )


def _check_feedforward(path: str, scenario: Scenario, aim: Aim) -> None:
    """The feed-forward belongs to the angle law on its leader-first-follower graph, all followers active."""
    if scenario.law.name != "angle" or aim.formation is not aim.target:
        raise InputError(f'{path}: law.feedforward: only for law.name = "angle", got "{scenario.law.name}"')
    if scenario.law.without_neighbour == "another-pair":
        raise InputError(f'{path}: law.feedforward: it is of one pair of neighbours, expected none with "another-pair"')
    if scenario.law.activation == "sequential":
        raise InputError(f"{path}: law.feedforward: followers that wait cannot follow, expected all to be active")


def _arena(path: str, scenario: Scenario) -> Arena:
    obstacles = []
    for number, table in enumerate(scenario.obstacles, start=1):
        with located(path, f"obstacles[{number}]"):
            obstacles.append(Obstacle(np.array(table.vertices_m), table.radius_m))
    with located(path, "arena"):
        return Arena(scenario.arena.x_m, scenario.arena.y_m, scenario.arena.walls, tuple(obstacles))


def _filter_settings(path: str, scenario: Scenario) -> FilterSettings:
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


def _needed(file: ScenarioFile) -> str:
    """The condition on the sensing graph that the law declares, a key of ``formation.graph.conditions.CONDITIONS``."""
    table = file.scenario.law
    if table.name == "own" and table.without_neighbour == "another-pair":
        raise InputError(f'{file.path}: law.without_neighbour: "another-pair" is for law.name = "angle", got "own"')
    if table.name != "own":
        return LAWS[table.name].graph if table.name in LAWS else LEADER_FIRST_FOLLOWER
    return LEADER_FIRST_FOLLOWER if file.law is None or table.factory is None else condition(file.law, table.factory)


def _law(file: ScenarioFile, aim: Aim, phases: tuple[Phase, ...], to_run: bool, own_gains: Real | None) -> FormationLaw:
    table = file.scenario.law
    if table.name != "own":
        return _built_in(file.path, table, aim, own_gains)
    if not to_run or file.law is None or table.factory is None:
        return NotLoaded()
    factory = OwnFactory(file.path, file.law, table.factory, table.parameters)
    return factory.make(aim.formation, phases[0].delta)


def _built_in(path: str, table: LawTable, aim: Aim, own_gains: Real | None) -> FormationLaw:
    if isinstance(aim.formation, TargetFormation) and table.name == "angle":
        check_parameters(path, "the angle law", lambda target: None, table.parameters)
        kind = AnotherPairLaw if table.without_neighbour == "another-pair" else AngleLaw
        return kind(aim.formation, table.first_follower, own_gains)
    if table.without_neighbour == "another-pair":
        raise InputError(f'{path}: law.without_neighbour: "another-pair" is for law.name = "angle", got "{table.name}"')
    make = LAWS[table.name]
    check_parameters(path, f"the {table.name} law", make, table.parameters)
    with located(path, "law"):
        return make(aim.formation, **table.parameters)


def _own_gains(path: str, scenario: Scenario, aim: Aim) -> Real | None:
    """(n - 2,) the gain of each follower on top of eq. (u); None where all are 1, and for other laws.

    Raises:
        InputError: a gain for an agent that has none, or for a law that has none.
    """
    given = [agent for agent in in_order(scenario.agents) if agent.gain is not None]
    if scenario.law.name != "angle" or not isinstance(aim.formation, TargetFormation):
        if given or scenario.law.gain != "paper":
            field = "law.gain" if not given else f"agents[id {given[0].id}].gain"
            raise InputError(f"{path}: {field}: only for the angle law")
        return None
    for agent in given:
        if agents.rows(agent.id) < agents.FIRST_ORDINARY:
            raise InputError(f"{path}: agents[id {agent.id}].gain: leader and first follower have none")
    if not given and scenario.law.gain == "paper":
        return None
    rates = decay_rates(aim.formation)
    gains = np.ones(len(rates)) if scenario.law.gain == "paper" else 1.0 / rates
    for agent in given:
        gains[agents.rows(agent.id) - agents.FIRST_ORDINARY] = agent.gain
    return gains


def _estimator(path: str, scenario: Scenario, graph: Graph) -> VelocityEstimator | None:
    if scenario.velocity_known_by == "all":
        return None
    table = scenario.communication
    edges = graph.edges if table.edges is None else agents.rows(table.edges)
    with located(path, "communication.edges"):
        return VelocityEstimator(graph.n, edges, table.gain_per_s)


def _instruments(path: str, scenario: Scenario, law: FormationLaw, graph: Graph) -> Instruments:
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


def _robot(scenario: Scenario) -> RobotModel:
    table = scenario.robot
    return RobotModel(
        drive=replace(GTERNAL.drive, wheel_speed_limit=table.wheel_speed_limit_rad_s),
        chassis=replace(GTERNAL.chassis, tyre_friction=table.tyre_friction, body_friction=table.body_friction),
    )


def _fleet(path: str, scenario: Scenario, nid: NearIdentityDiffeomorphism, robot: RobotModel, n: int) -> Fleet:
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


def _phases(path: str, scenario: Scenario, formation: Framework, duration: float | None) -> tuple[Phase, ...]:
    """The maneuver, cut or extended to ``duration``; one phase named after the law's aim where no phases are given."""
    deltas = _displacements(path, scenario, formation)
    if scenario.reference is not None:
        reference = build_reference(path, scenario.reference)
        velocity = complex(reference.velocity(0.0))
        length = duration or scenario.duration_s or 0.0
        return (Phase(scenario.reference.kind, length, (velocity.real, velocity.imag), deltas[0], reference),)
    if not scenario.phases:
        return (Phase("shape", duration or scenario.duration_s or 0.0, delta=deltas[0]),)
    phases, elapsed = [], 0.0
    for table, delta in zip(scenario.phases, deltas, strict=True):
        length = table.duration_s
        if duration is not None:
            last = table is scenario.phases[-1]
            length = duration - elapsed if last else min(length, duration - elapsed)
        if length > 0.0:
            phases.append(Phase(table.name, length, table.velocity_m_s, delta))
        elapsed += length
    return tuple(phases)


def _displacements(path: str, scenario: Scenario, formation: Framework) -> list[tuple[float, float] | None]:
    """delta_12 of each phase: the scenario's, or that of p* for a law that takes its own from the target."""
    if scenario.reference is not None:
        given = [scenario.reference.displacement_m]
    else:
        given = [phase.displacement_m for phase in scenario.phases] or [None]
    for number, delta in enumerate(given, start=1):
        if delta is not None and not any(delta):
            field = "reference" if scenario.reference is not None else f"phases[{number}]"
            raise InputError(f"{path}: {field}.displacement_m: agents 1 and 2 must not be sent to one place")
    if scenario.law.name == "own":
        return given
    if scenario.law.name != "angle":
        if not LAWS[scenario.law.name].steers:
            if any(delta is not None for delta in given):
                field = "phases" if scenario.reference is None else "reference"
                raise InputError(f"{path}: {field}.displacement_m: the {scenario.law.name} law follows none")
            return given
        return [_of_target(formation) if delta is None else delta for delta in given]
    if scenario.law.first_follower == "stationary":
        return given
    if scenario.reference is not None:
        return [given[0] or _of_target(formation)]
    if not scenario.phases:
        raise InputError(f"{path}: law.first_follower: {scenario.law.first_follower!r} needs phases to follow")
    for number, delta in enumerate(given, start=1):
        if delta is None:
            raise InputError(f"{path}: phases[{number}].displacement_m: missing")
    return given


def _of_target(formation: Framework) -> tuple[float, float]:
    """p*_2 - p*_1, metres."""
    x, y = formation.positions[agents.FIRST_FOLLOWER] - formation.positions[agents.LEADER]
    return float(x), float(y)
