"""Sensing graphs of any kind, and the conditions that laws put on them."""

import numpy as np
import pytest

from formation import DirectedGraph, Framework, SensingGraph, agents, random_target
from formation.graph.conditions import CONDITIONS
from formation.graph.designs import DESIGNS, design

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.1], [0.0, 1.0]])
RING = [[1, 2], [2, 3], [3, 4], [4, 1]]


def framework(edges: list[list[int]], both: bool = False) -> Framework:
    rows = agents.rows(edges)
    graph = DirectedGraph.both_ways(4, rows) if both else DirectedGraph(4, rows)
    return Framework(graph, SQUARE)


def test_edges_are_sorted_by_observer_and_each_corner_is_a_pair_of_edges_with_one_observer() -> None:
    graph = DirectedGraph(4, agents.rows([[4, 2], [4, 1], [2, 1], [4, 3]]))
    assert agents.numbers(graph.edges).tolist() == [[2, 1], [4, 1], [4, 2], [4, 3]]
    assert graph.corners.tolist() == [[1, 2], [1, 3], [2, 3]]
    assert (agents.numbers(graph.neighbours(3)) == [1, 2, 3]).all()


def test_a_leader_first_follower_graph_has_one_corner_for_each_follower() -> None:
    graph = SensingGraph.random(9, np.random.default_rng(0))
    assert (graph.edges[graph.corners[:, 0], 0] == graph.followers).all()
    assert (graph.edges[graph.corners, 1] == graph.neighbours).all()


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ([[1, 5]], r"edge \(1, 5\) names an agent outside 1\.\.4"),
        ([[2, 2]], "agent 2 senses itself"),
        ([[3, 1], [3, 1]], "agent 3 senses agent 1 twice"),
    ],
)
def test_an_edge_that_cannot_be_is_named(edges: list[list[int]], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DirectedGraph(4, agents.rows(edges))


@pytest.mark.parametrize(
    ("condition", "edges", "both", "message"),
    [
        ("undirected", [[1, 2], [2, 1], [3, 1]], False, r"edge \(3, 1\) is sensed from one end; agent 1 must sense it"),
        ("undirected", [[1, 2], [3, 4]], True, "agent 3 is not connected to agent 1"),
        ("rigid", RING, True, "not rigid: 4 of 5 constraints"),
        ("bearing rigid", RING, True, "not bearing rigid: 4 of 5 constraints"),
        ("rooted", [[2, 1], [3, 4], [4, 3]], False, "no chain of sensing edges leads from agent 3"),
        ("two-rooted", [[3, 1], [4, 3]], False, "agent 3 has no two separate chains"),
        ("two-rooted", [[3, 1], [3, 2], [4, 3]], False, "agent 4 has no two .* none is left without agent 3"),
        ("leader-first-follower", [[2, 1], [3, 4], [4, 3]], False, "Assumption 1"),
    ],
)
def test_a_condition_names_the_agent_or_the_edge_that_breaks_it(
    condition: str, edges: list[list[int]], both: bool, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        CONDITIONS[condition](framework(edges, both))


@pytest.mark.parametrize(
    ("condition", "edges", "both"),
    [
        ("undirected", RING, True),
        ("rigid", [*RING, [1, 3]], True),
        ("bearing rigid", [*RING, [1, 3]], True),
        ("rooted", [[2, 1], [3, 2], [4, 3]], False),
        ("two-rooted", [[3, 2], [3, 4], [4, 3], [4, 1]], False),
        ("leader-first-follower", [[2, 1], [3, 1], [3, 2], [4, 2], [4, 3]], False),
    ],
)
def test_a_graph_that_fulfils_a_condition_passes(condition: str, edges: list[list[int]], both: bool) -> None:
    CONDITIONS[condition](framework(edges, both))


@pytest.mark.parametrize("condition", DESIGNS)
@pytest.mark.parametrize("seed", range(3))
def test_what_is_designed_fulfils_its_condition_and_stays_as_it_is_when_designed_again(
    condition: str, seed: int
) -> None:
    target = random_target(3 if condition == "triangle" else 7, np.random.default_rng(seed))
    designed = design(condition, target)
    CONDITIONS[condition](designed)
    assert design(condition, designed) is designed
