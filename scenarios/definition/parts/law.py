"""The formation law of a scenario: what graph it needs, what it is made of, what it refuses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation import LAWS, AngleLaw, FormationLaw, Phase, TargetFormation, agents, decay_rates
from formation.laws.another_pair import AnotherPairLaw
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from scenarios.definition.bounds import LONGEST_RUN
from scenarios.definition.formations import Aim
from scenarios.definition.load import ScenarioFile
from scenarios.definition.own_law import NotLoaded, OwnFactory, check_parameters, condition
from scenarios.definition.schema import LawTable, Scenario
from scenarios.definition.targets import in_order
from scenarios.errors import InputError, located

Real = NDArray[np.float64]


def needed_graph(file: ScenarioFile) -> str:
    """The condition on the sensing graph that the law declares, a key of ``formation.graph.conditions.CONDITIONS``."""
    table = file.scenario.law
    if table.name == "own" and table.without_neighbour == "another-pair":
        raise InputError(f'{file.path}: law.without_neighbour: "another-pair" is for law.name = "angle", got "own"')
    if table.name != "own":
        return LAWS[table.name].graph if table.name in LAWS else LEADER_FIRST_FOLLOWER
    return LEADER_FIRST_FOLLOWER if file.law is None or table.factory is None else condition(file.law, table.factory)


def make_law(file: ScenarioFile, aim: Aim, phases: tuple[Phase, ...], to_run: bool, gains: Real | None) -> FormationLaw:
    """The law that the scenario names, for its aim; an own law is a stand-in where nothing will run.

    Args:
        gains: those of :func:`own_gains`.

    Raises:
        InputError: the law has no such parameter, does not suit the aim, or cannot be made.
    """
    table = file.scenario.law
    if table.name != "own":
        return _built_in(file.path, table, aim, gains)
    if not to_run or file.law is None or table.factory is None:
        return NotLoaded()
    factory = OwnFactory(file.path, file.law, table.factory, table.parameters)
    return factory.make(aim.formation, phases[0].delta)


def _built_in(path: str, table: LawTable, aim: Aim, gains: Real | None) -> FormationLaw:
    if isinstance(aim.formation, TargetFormation) and table.name == "angle":
        check_parameters(path, "the angle law", lambda target: None, table.parameters)
        kind = AnotherPairLaw if table.without_neighbour == "another-pair" else AngleLaw
        return kind(aim.formation, table.first_follower, gains)
    if table.without_neighbour == "another-pair":
        raise InputError(f'{path}: law.without_neighbour: "another-pair" is for law.name = "angle", got "{table.name}"')
    make = LAWS[table.name]
    check_parameters(path, f"the {table.name} law", make, table.parameters)
    with located(path, "law"):
        return make(aim.formation, **table.parameters)


def own_gains(path: str, scenario: Scenario, aim: Aim) -> Real | None:
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


def check_rates(path: str, target: TargetFormation, control_period: float) -> None:
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


def check_feedforward(path: str, scenario: Scenario, aim: Aim) -> None:
    """The feed-forward belongs to the angle law on its leader-first-follower graph, all followers active."""
    if scenario.law.name != "angle" or aim.formation is not aim.target:
        raise InputError(f'{path}: law.feedforward: only for law.name = "angle", got "{scenario.law.name}"')
    if scenario.law.without_neighbour == "another-pair":
        raise InputError(f'{path}: law.feedforward: it is of one pair of neighbours, expected none with "another-pair"')
    if scenario.law.activation == "sequential":
        raise InputError(f"{path}: law.feedforward: followers that wait cannot follow, expected all to be active")
