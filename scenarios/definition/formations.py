"""The formation that a scenario's law is made for: its sensing graph, given or designed, and the target's shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import AngleSet, DirectedGraph, Framework, SensingGraph, TargetFormation, agents
from formation.graph.conditions import CONDITIONS
from formation.graph.designs import design
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from scenarios.definition.schema import Scenario
from scenarios.definition.targets import build_target, in_order, listed_angles
from scenarios.errors import InputError, did_you_mean, located

Real = NDArray[np.float64]

TRIANGLE = "triangle"
"""The condition of laws for three agents, which no choice of edges meets for more."""


@dataclass(frozen=True, eq=False)
class Aim:
    """What a run is after.

    Attributes:
        formation: what the law is made for.
        target: the target on the scenario's leader-first-follower graph; None where it has none.
        angles: the angles that are measured and compared.
        target_angles: (m,) their targets, radians, exact.
    """

    formation: Framework
    target: TargetFormation | None
    angles: AngleSet
    target_angles: Real


def build_aim(path: str, scenario: Scenario, condition: str) -> Aim:
    """The aim of a scenario.

    Args:
        path: of the scenario file, for messages.
        scenario: validated.
        condition: on the sensing graph, that the law declares.

    Raises:
        InputError: a graph that is not of the kind that the law needs, and everything that makes no target.
    """
    if condition == LEADER_FIRST_FOLLOWER or scenario.random_formation is not None or not _others(scenario):
        target, angles, exact = build_target(path, scenario)
        given: Framework = target
        aim = Aim(target, target, angles, exact)
    else:
        with located(path, "agents"):
            given = _given(path, scenario)
        angles = listed_angles(path, scenario, given) or AngleSet.of_places(given.positions)
        aim = Aim(given, None, angles, angles.measure(given.positions))
    return _with_graph(path, scenario, aim, condition)


def _with_graph(path: str, scenario: Scenario, aim: Aim, condition: str) -> Aim:
    """The aim with a sensing graph of the kind that a law needs: checked where it is given, built where it is designed.

    Raises:
        InputError: the given graph is of another kind; the message names the agent or the edge, and the way out.
    """
    if condition not in CONDITIONS:
        raise InputError(f"{path}: law.graph: no such condition {condition!r}, {did_you_mean(condition, CONDITIONS)}")
    if scenario.graph == "design":
        with located(path, "graph"):
            return Aim(design(condition, aim.formation), aim.target, aim.angles, aim.target_angles)
    try:
        CONDITIONS[condition](aim.formation)
    except ValueError as error:
        offer = "" if condition == TRIANGLE else '; graph = "design" builds one'
        raise InputError(
            f"{path}: agents: the {scenario.law.name} law needs a graph that is {condition}: {error}{offer}"
        ) from error
    return aim


def _others(scenario: Scenario) -> bool:
    """Whether the agents' neighbours make another graph than a leader-first-follower one."""
    edges = [(agent.id, neighbour) for agent in scenario.agents for neighbour in agent.neighbours]
    try:
        SensingGraph.from_edges(len(scenario.agents), agents.rows(edges))
    except ValueError:
        return True
    return False


def _given(path: str, scenario: Scenario) -> Framework:
    ordered = in_order(scenario.agents)
    edges = [(agent.id, neighbour) for agent in ordered for neighbour in agent.neighbours]
    for agent in ordered:
        if agent.target is None:
            raise InputError(
                f"{path}: agents[id {agent.id}].target: missing; a shape is defined by angles alone only on a "
                "leader-first-follower graph"
            )
    return Framework(DirectedGraph(len(ordered), agents.rows(edges)), np.array([agent.target for agent in ordered]))
