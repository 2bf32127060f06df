"""Whom each agent senses where the scenario does not say it outright: the graph inside a given one, or a designed one.

Rows of all arrays are in the order of the cascade. The agents keep the numbers that the file gives them: what is made
here is the scenario with its agents renumbered by row, and the numbers by which people know them.
"""

from __future__ import annotations

import re

import numpy as np

from formation import SensingGraph, agents
from formation.design.candidates import Task, choose, propose
from formation.design.field import Choice, Field
from formation.design.subgraph import Remedy, free_remedy, remedy, subgraph
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from scenarios.definition.schema import AgentTable, Scenario
from scenarios.definition.targets import drawn_target, in_order
from scenarios.errors import InputError, did_you_mean, located

LEADERS = (1, 2)
"""Numbers of the leader and of the first follower where the scenario names none."""


def chosen(path: str, scenario: Scenario, condition: str) -> tuple[Scenario, tuple[int, ...] | None]:
    """The scenario with agents 1..n in the order of the cascade, and their numbers in the file, row by row.

    None where the graph is given: then the file's numbers are the rows' already.

    Args:
        path: of the scenario file, for messages.
        scenario: validated.
        condition: on the sensing graph, that the law declares.

    Raises:
        InputError: no leader-first-follower graph is inside; the message names whom it cannot reach and what mends it.
    """
    if scenario.graph == "given":
        if scenario.leaders is not None:
            raise InputError(f'{path}: leaders: only for graph = "subgraph" or "design"')
        return scenario, None
    if condition != LEADER_FIRST_FOLLOWER:
        if scenario.graph == "subgraph":
            raise InputError(f'{path}: graph: "subgraph" needs a law on a leader-first-follower graph')
        return scenario, None
    ordered = _agents(path, scenario)
    numbers = [agent.id for agent in ordered]
    leaders = _leaders(path, scenario, numbers)
    places = np.array([agent.target for agent in ordered])
    if scenario.graph == "subgraph":
        choice = _inside(path, scenario, ordered, places, leaders)
    else:
        choice = _designed(path, scenario, ordered, places, leaders)
    return _renumbered(path, scenario, ordered, choice), tuple(numbers[row] for row in choice.order)


def sensed_edges(path: str, ordered: list[AgentTable]) -> np.ndarray:
    """(m, 2) rows (observer, observed) of the agents' neighbours.

    Raises:
        InputError: a neighbour that is no agent, or the agent itself.
    """
    row = {agent.id: place for place, agent in enumerate(ordered)}
    edges = []
    for agent in ordered:
        for neighbour in agent.neighbours:
            if neighbour not in row or neighbour == agent.id:
                raise InputError(
                    f"{path}: agents[id {agent.id}].neighbours: expected numbers of other agents, got {neighbour}"
                )
            edges.append((row[agent.id], row[neighbour]))
    return np.array(edges, dtype=np.intp).reshape(-1, 2)


def explain(numbers: list[int], found: Choice, mend: Remedy, free: Remedy | None) -> str:
    """Which agents a graph does not reach from its leaders, and the fewest edges that would mend it."""
    a, b = (numbers[row] for row in found.leaders)
    left = [str(numbers[row]) for row in found.unreached.tolist()]
    lost = f"agent{'s' * (len(left) > 1)} {', '.join(left)} cannot be reached" if left else f"agent {b} must sense {a}"
    words = [
        f"no leader-first-follower graph with the leaders {a} and {b} is inside: {lost}; "
        f"{_edges(numbers, mend)} would do{', and no fewer' if mend.fewest else ''}"
    ]
    if free is not None and len(free.edges) < len(mend.edges):
        first, second = (numbers[row] for row in free.leaders)
        what = _edges(numbers, free) if free.edges else "none is missing"
        words.append(f"with leaders = [{first}, {second}] {what}")
    return "; ".join(words)


def needs_edge(scenario: Scenario) -> bool:
    """Whether the first follower's law measures where the leader is."""
    return scenario.law.name != "angle" or scenario.law.first_follower != "stationary"


def _edges(numbers: list[int], mend: Remedy) -> str:
    named = ", ".join(f"({numbers[k]}, {numbers[i]})" for k, i in mend.edges)
    return f"the edge{'s' * (len(mend.edges) > 1)} {named}"


def _agents(path: str, scenario: Scenario) -> list[AgentTable]:
    if scenario.random_formation is not None:
        if scenario.graph == "subgraph":
            raise InputError(f"{path}: graph: random_formation has a graph of its own, expected given or design")
        places = drawn_target(path, scenario.random_formation).positions.tolist()
        return [AgentTable(id=number, target=(x, y)) for number, (x, y) in enumerate(places, start=1)]
    ordered = in_order(scenario.agents)
    for agent in ordered:
        if agent.target is None:
            raise InputError(f"{path}: agents[id {agent.id}].target: missing, a graph is chosen by target positions")
    return ordered


def _leaders(path: str, scenario: Scenario, numbers: list[int]) -> tuple[int, int]:
    a, b = scenario.leaders or LEADERS
    for number in (a, b):
        if number not in numbers:
            raise InputError(f"{path}: leaders: no agent {number}, {did_you_mean(str(number), map(str, numbers))}")
    if a == b:
        raise InputError(f"{path}: leaders: expected two agents, got {a} twice")
    return numbers.index(a), numbers.index(b)


def _inside(
    path: str, scenario: Scenario, ordered: list[AgentTable], places: np.ndarray, leaders: tuple[int, int]
) -> Choice:
    field, numbers = Field.of_edges(places, sensed_edges(path, ordered)), [agent.id for agent in ordered]
    needed = needs_edge(scenario)
    found = subgraph(field, leaders)
    if found.whole and (not needed or field.allowed[leaders[1], leaders[0]]):
        return found
    with located(path, "graph"):
        words = explain(numbers, found, remedy(field, leaders, needed), free_remedy(field, needed))
    raise InputError(f"{path}: graph: {words}")


def _designed(
    path: str, scenario: Scenario, ordered: list[AgentTable], places: np.ndarray, leaders: tuple[int, int]
) -> Choice:
    starts = [agent.start for agent in ordered if agent.start is not None]
    start = np.array(starts) if len(starts) == len(ordered) else scattered(places)
    steered = needs_edge(scenario)
    task = Task(start, "displacement" if steered else "stationary", period=scenario.plant.control_period_s)
    candidates = propose(Field.open(places), task, leaders)
    if not candidates:
        raise InputError(f"{path}: graph: the target is degenerate, no graph with these leaders reaches every agent")
    return choose(candidates, "both").choice


def scattered(places: np.ndarray) -> np.ndarray:
    """(n, 2) starts that stand for any: the same for equal places, in the rectangle that these fill."""
    return np.random.default_rng(0).uniform(places.min(axis=0), places.max(axis=0), places.shape)


def _renumbered(path: str, scenario: Scenario, ordered: list[AgentTable], choice: Choice) -> Scenario:
    graph: SensingGraph = choice.graph()
    senses: list[list[int]] = [[] for _ in ordered]
    for k, i in graph.edges.tolist():
        senses[k].append(agents.number(i))
    new = {ordered[row].id: agents.number(place) for place, row in enumerate(choice.order.tolist())}
    tables = [
        ordered[row].model_copy(update={"id": agents.number(place), "neighbours": tuple(senses[place])})
        for place, row in enumerate(choice.order.tolist())
    ]

    def renamed(match: re.Match[str]) -> str:
        number = int(match.group())
        if number not in new:
            raise InputError(f"{path}: target.angles_deg: {match.string!r} names no agent {number}")
        return str(new[number])

    angles = {re.sub(r"\d+", renamed, name): value for name, value in scenario.target.angles_deg.items()}
    update: dict[str, object] = {
        "agents": tuple(tables),
        "random_formation": None,
        "graph": "given",
        "leaders": None,
        "target": scenario.target.model_copy(update={"angles_deg": angles}),
    }
    if (edges := scenario.communication.edges) is not None:
        for edge in edges:
            for number in edge:
                if number not in new:
                    raise InputError(f"{path}: communication.edges: no agent {number}")
        told = tuple((new[receiver], new[sender]) for receiver, sender in edges)
        update["communication"] = scenario.communication.model_copy(update={"edges": told})
    return scenario.model_copy(update=update)
