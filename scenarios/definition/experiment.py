"""From a validated scenario to the objects of the theory and of the machines."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formation import (
    LAWS,
    AngleSet,
    FormationLaw,
    Framework,
    Graph,
    Phase,
    TargetFormation,
    VelocityEstimator,
)
from formation.laws.base import ORIENTATION, SCALE
from robots import Arena, Fleet, Instruments, NearIdentityDiffeomorphism, RobotModel
from robots.measured import MeasuredModel
from robots.safety import FilterSettings
from scenarios.definition.bounds import check_size
from scenarios.definition.choice import chosen
from scenarios.definition.events.build import build_events, check_front
from scenarios.definition.events.event import RESHAPE, Event
from scenarios.definition.events.reshape import cut, reshaped
from scenarios.definition.files import robot_file
from scenarios.definition.formations import Aim, build_aim
from scenarios.definition.load import ScenarioFile, load
from scenarios.definition.parts import course, machines
from scenarios.definition.parts import law as laws
from scenarios.definition.schema import Scenario
from scenarios.definition.starts import Starts, build_starts
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
    needed = laws.needed_graph(file)
    scenario, numbers = chosen(path, file.scenario, needed)
    if duration is not None and not (np.isfinite(duration) and duration > 0.0):
        raise InputError(f"--duration: expected a positive number of seconds, got {duration:g}")
    check_size(path, scenario, duration)
    aim = build_aim(path, scenario, needed)
    with located(path, "robot"):
        robot = machines.robot_model(scenario)
        nid = NearIdentityDiffeomorphism(scenario.robot.projection_distance_m)
    if scenario.sensor.delay_periods and scenario.plant.name == "single_integrator":
        raise InputError(f"{path}: sensor.delay_periods: the plant single_integrator is continuous, expected 0")
    if scenario.law.name == "angle" and aim.target is not None:
        laws.check_rates(path, aim.target, scenario.plant.control_period_s)
    if scenario.law.feedforward:
        laws.check_feedforward(path, scenario, aim)
    if scenario.sensor.field_of_view_deg is not None:
        check_front(f"{path}: sensor.field_of_view_deg", scenario)
    arena = machines.arena(path, scenario)
    whom = numbers or tuple(range(1, aim.formation.graph.n + 1))
    events = build_events(path, scenario, whom, aim.formation.graph)
    phases, shapes = cut(course.phases(path, scenario, aim.formation, duration), events)
    own_gains = laws.own_gains(path, scenario, aim)
    law = laws.make_law(file, aim, phases, to_run, own_gains)
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
        estimator=machines.estimator(path, scenario, aim.formation.graph),
        instruments=machines.instruments(path, scenario, law, aim.formation.graph),
        nid=nid,
        robot=robot,
        arena=replace(arena, obstacles=(*arena.obstacles, *(each.obstacle for each in events if each.obstacle))),
        filter_settings=machines.filter_settings(path, scenario),
        measured=robot_file.measured(scenario, path),
        fleet=machines.fleet(path, scenario, nid, robot, aim.formation.graph.n),
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
