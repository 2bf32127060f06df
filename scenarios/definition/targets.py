"""The target formation of a scenario: from positions, from angles, or random; and the angles that are measured."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from formation import (
    AngleSet,
    Framework,
    SensingGraph,
    TargetFormation,
    agents,
    random_target,
    target_from_angles,
    wrap,
)
from scenarios.definition.schema import AgentTable, RandomFormationTable, Scenario
from scenarios.errors import InputError, located

Real = NDArray[np.float64]

PRINTED_DEGREES = 0.005
"""Degrees by which an angle that is listed with two decimals may differ from the exact one."""


def build_target(path: str, scenario: Scenario) -> tuple[TargetFormation, AngleSet, Real]:
    """The target formation, the measured angles, and their exact targets (m,), radians.

    Args:
        path: of the scenario file, for messages.
        scenario: validated.

    Raises:
        InputError: a graph that breaks Assumption 1, a degenerate target, angles that fit no shape or another one.
    """
    if scenario.random_formation is not None:
        target = drawn_target(path, scenario.random_formation)
    else:
        with located(path, "agents"):
            graph = _graph(scenario.agents)
        missing = [agent.id for agent in scenario.agents if agent.target is None]
        if len(missing) == len(scenario.agents):
            target = _from_angles(path, scenario, graph)
        elif missing:
            raise InputError(f"{path}: agents[id {missing[0]}].target: missing")
        else:
            with located(path, "agents"):
                target = TargetFormation(graph, np.array([agent.target for agent in in_order(scenario.agents)]))
    angles = listed_angles(path, scenario, target) or AngleSet.of_followers(target.graph)
    return target, angles, angles.measure(target.positions)


def listed_angles(path: str, scenario: Scenario, formation: Framework) -> AngleSet | None:
    """The angles that the scenario lists; None if it lists none.

    Raises:
        InputError: an angle that names no agents, or another value than the positions have.
    """
    angles = _listed(path, scenario, formation.graph.n)
    if angles is not None:
        _compare(path, scenario, angles.measure(formation.positions))
    return angles


def in_order(given: tuple[AgentTable, ...]) -> list[AgentTable]:
    """The agents by number."""
    return sorted(given, key=lambda agent: agent.id)


def _graph(given: tuple[AgentTable, ...]) -> SensingGraph:
    edges = [(agent.id, neighbour) for agent in in_order(given) for neighbour in agent.neighbours]
    return SensingGraph.from_edges(len(given), agents.rows(edges))


def drawn_target(path: str, table: RandomFormationTable) -> TargetFormation:
    """The target of a random formation.

    Raises:
        InputError: the disc has no room for it.
    """
    with located(path, "random_formation"):
        return random_target(
            table.agents,
            np.random.default_rng(table.seed),
            np.radians(table.min_angle_deg),
            table.min_separation_m,
            table.radius_m,
        )


def _from_angles(path: str, scenario: Scenario, graph: SensingGraph) -> TargetFormation:
    listed = _listed(path, scenario, graph.n)
    if listed is None:
        raise InputError(f"{path}: target.angles_deg: missing, and the agents have no target positions either")
    degrees = np.array(list(scenario.target.angles_deg.values()))
    with located(path, "target.angles_deg"):
        return target_from_angles(graph, listed, np.radians(degrees), np.radians(2.0 * PRINTED_DEGREES))


def _listed(path: str, scenario: Scenario, n: int) -> AngleSet | None:
    triples = []
    for name in scenario.target.angles_deg:
        match = re.fullmatch(r"\s*(\d+)\s*;\s*(\d+)\s*,\s*(\d+)\s*", name)
        if match is None:
            raise InputError(f"{path}: target.angles_deg: expected a name as in '3;2,4', got {name!r}")
        triple = [int(number) for number in match.groups()]
        for number in triple:
            if not 1 <= number <= n:
                raise InputError(f"{path}: target.angles_deg: {name!r} names agent {number} outside 1..{n}")
        triples.append(agents.rows(triple))
    if not triples:
        return None
    with located(path, "target.angles_deg"):
        return AngleSet(np.array(triples))


def _compare(path: str, scenario: Scenario, exact: Real) -> None:
    for (name, degrees), radians in zip(scenario.target.angles_deg.items(), exact, strict=False):
        difference = abs(np.degrees(wrap(np.radians(degrees) - radians)))
        if not difference <= PRINTED_DEGREES + 1e-9:
            raise InputError(
                f"{path}: target.angles_deg.{name!r}: the target positions have {np.degrees(radians):.4f} degrees, "
                f"got {degrees:g}"
            )
