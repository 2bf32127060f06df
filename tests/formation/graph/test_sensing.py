"""The sensing graph and the clauses of Assumption 1."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import SensingGraph, agents

PAPER = [(2, 1), (3, 1), (3, 2), (4, 2), (4, 3), (5, 1), (5, 4), (6, 1), (6, 4)]


def paper_graph() -> SensingGraph:
    return SensingGraph.from_edges(6, agents.rows(PAPER))


def changed(take: tuple[int, int], give: tuple[int, int]) -> np.ndarray:
    return agents.rows([give if edge == take else edge for edge in PAPER])


seeds = st.integers(0, 2**32 - 1)


@given(st.integers(3, 60), seeds)
def test_random_graphs_satisfy_assumption_1(n: int, seed: int) -> None:
    graph = SensingGraph.random(n, np.random.default_rng(seed))
    out_degree = np.bincount(graph.edges[:, 0], minlength=n)
    assert graph.n == n
    assert out_degree.tolist() == [0, 1] + [2] * (n - 2)
    assert (graph.edges[:, 1] < graph.edges[:, 0]).all()
    assert (graph.neighbours[:, 0] < graph.neighbours[:, 1]).all()


@given(st.integers(3, 30), seeds)
def test_edges_in_any_order_give_the_same_graph(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = SensingGraph.random(n, rng)
    again = SensingGraph.from_edges(n, rng.permutation(graph.edges))
    assert (again.neighbours == graph.neighbours).all()


def test_random_graphs_choose_every_pair_about_equally_often() -> None:
    rng = np.random.default_rng(0)
    drawn = np.array([SensingGraph.random(5, rng).neighbours[2] for _ in range(6000)])
    pairs, counts = np.unique(drawn, axis=0, return_counts=True)
    assert len(pairs) == 6
    assert np.abs(counts / 1000.0 - 1.0).max() < 0.15


@given(st.integers(3, 40), seeds)
def test_depth_is_one_more_than_the_deepest_neighbours(n: int, seed: int) -> None:
    graph = SensingGraph.random(n, np.random.default_rng(seed))
    assert graph.depth[:2].tolist() == [0, 1]
    for k, pair in zip(graph.followers, graph.neighbours, strict=True):
        assert graph.depth[k] == 1 + graph.depth[pair].max()


def test_the_papers_graph_has_its_edges_and_depths() -> None:
    graph = paper_graph()
    assert [tuple(e) for e in agents.numbers(graph.edges).tolist()] == PAPER
    assert graph.depth.tolist() == [0, 1, 2, 3, 4, 4]


def test_the_papers_formation_graph_adds_the_edge_between_1_and_4_which_do_not_sense_each_other() -> None:
    graph = paper_graph()
    added = agents.numbers(graph.formation_edges[len(graph.edges) :]).tolist()
    assert added == [[4, 1]]
    assert [4, 1] not in agents.numbers(graph.edges).tolist()


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        (changed((3, 2), (3, 4)), r"clause \(ii\): agent 3 senses agent 4"),
        (changed((2, 1), (2, 2)), r"clause \(ii\): agent 2 senses agent 2"),
        (changed((2, 1), (1, 2)), r"clause \(ii\): agent 1 senses agent 2"),
        (changed((3, 2), (4, 1)), r"clause \(i\): agent 3 has 1 neighbour, expected 2"),
        (changed((2, 1), (3, 1)), r"clause \(i\): agent 2 has 0 neighbours, expected 1"),
        (changed((6, 4), (6, 1)), r"clause \(i\): agent 6 senses agent 1 twice"),
        (changed((6, 4), (6, 7)), r"edge \(6, 7\) names an agent outside 1\.\.6"),
        (changed((6, 4), (6, 0)), r"edge \(6, 0\) names an agent outside 1\.\.6"),
    ],
)
def test_a_broken_graph_is_refused_with_clause_and_agent(edges: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SensingGraph.from_edges(6, edges)


@pytest.mark.parametrize(
    ("neighbours", "message"),
    [
        ([[0, 1, 2]], "shape"),
        ([0, 1], "shape"),
        ([[0, 2]], r"clause \(ii\): agent 3 senses agent 3"),
        ([[1, 1]], r"clause \(i\): agent 3 senses agent 2 twice"),
        ([[-1, 1]], "agent 3 senses agent 0, agents are numbered from 1"),
    ],
)
def test_broken_neighbour_pairs_are_refused(neighbours: list[object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SensingGraph(np.array(neighbours))


def test_graphs_too_small_are_refused() -> None:
    with pytest.raises(ValueError, match="at least 2 agents, got 1"):
        SensingGraph.from_edges(1, [])
    with pytest.raises(ValueError, match="at least 3 agents, got 2"):
        SensingGraph.random(2, np.random.default_rng(0))


def test_a_graph_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        paper_graph().neighbours[0, 0] = 1
