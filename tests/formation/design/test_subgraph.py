"""The graph inside a graph is found, or its absence explained and mended by as few edges as can be."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation.design.field import Field
from formation.design.subgraph import any_leaders, free_remedy, remedy, subgraph

PENTAGON = np.array([[0.0, 0.0], [-1.9021, -1.3820], [-1.1756, -3.6180], [1.1756, -3.6180], [1.9021, -1.3820]])
CYCLE = np.array([[1, 0], [2, 1], [2, 3], [3, 2], [3, 4], [4, 0], [4, 3]])


def mended(field: Field, edges: tuple[tuple[int, int], ...]) -> Field:
    allowed = field.allowed.copy()
    for k, i in edges:
        allowed[k, i] = True
    return Field(field.positions, allowed)


def test_no_single_edge_mends_the_pentagons_cycle_with_given_leaders_and_the_two_proposed_do() -> None:
    field = Field.of_edges(PENTAGON, CYCLE)
    assert subgraph(field, (0, 1)).unreached.tolist() == [2, 3, 4]
    found = remedy(field, (0, 1), needs_edge=False)
    assert len(found.edges) == 2
    assert found.fewest
    assert subgraph(mended(field, found.edges), (0, 1)).whole
    missing = [(k, i) for k in range(5) for i in range(5) if k != i and not field.allowed[k, i]]
    assert not any(subgraph(mended(field, (edge,)), (0, 1)).whole for edge in missing)


def test_with_free_leaders_one_edge_mends_the_pentagons_cycle() -> None:
    field = Field.of_edges(PENTAGON, CYCLE)
    assert any_leaders(field, needs_edge=False) is None
    found = free_remedy(field, needs_edge=False)
    assert found is not None
    assert len(found.edges) == 1
    assert subgraph(mended(field, found.edges), found.leaders).whole


@settings(max_examples=15)
@given(seed=st.integers(0, 2**32 - 1), needs_edge=st.booleans())
def test_no_fewer_edges_than_proposed_mend_a_random_graph(seed: int, needs_edge: bool) -> None:
    rng = np.random.default_rng(seed)
    field = Field(rng.normal(size=(5, 2)), (rng.uniform(size=(5, 5)) < 0.3) & ~np.eye(5, dtype=bool))

    def whole(edges: tuple[tuple[int, int], ...]) -> bool:
        tried = mended(field, edges)
        return subgraph(tried, (0, 1)).whole and (bool(tried.allowed[1, 0]) or not needs_edge)

    found = remedy(field, (0, 1), needs_edge)
    assert whole(found.edges)
    missing = [(k, i) for k in range(5) for i in range(5) if k != i and not field.allowed[k, i]]
    fewer = [len(found.edges) - 1] if found.edges else []
    assert not any(whole(edges) for size in fewer for edges in combinations(missing, size))


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(4, 12))
def test_a_leader_first_follower_graph_hidden_among_other_edges_and_numbers_is_found(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    shuffled = rng.permutation(n)
    edges = [(shuffled[k], shuffled[i]) for k in range(2, n) for i in rng.choice(k, 2, replace=False)]
    edges += [(int(a), int(b)) for a, b in rng.integers(0, n, (n, 2))]
    field = Field.of_edges(rng.normal(size=(n, 2)), np.array(edges))
    choice = subgraph(field, (int(shuffled[0]), int(shuffled[1])))
    assert choice.whole
    graph = choice.graph()
    assert graph.n == n
    sensed = choice.order[graph.edges[1:]]
    assert field.allowed[tuple(sensed.T)].all()


def test_a_graph_that_lacks_agents_is_no_graph_yet() -> None:
    choice = subgraph(Field.of_edges(PENTAGON, CYCLE), (0, 1))
    with pytest.raises(ValueError, match="not reached"):
        choice.graph()


def test_of_many_agents_out_of_reach_a_remedy_is_found_that_may_not_be_the_smallest() -> None:
    places = np.random.default_rng(4).normal(size=(15, 2))
    nobody = Field(places, np.zeros((15, 15), dtype=bool))
    found = remedy(nobody, (0, 1), needs_edge=True)
    assert not found.fewest
    assert found.edges[0] == (1, 0)
    assert len(found.edges) == 1 + 2 * 13
    assert subgraph(mended(nobody, found.edges), (0, 1)).whole
    few = Field(places[:8], np.zeros((8, 8), dtype=bool))
    assert remedy(Field(places[:3], few.allowed[:3, :3]), (0, 1), needs_edge=False).fewest
    linked = few.allowed.copy()
    linked[2:, 2:] = ~np.eye(6, dtype=bool)  # all the others see each other: two of them have to be given two edges
    found = remedy(Field(places[:8], linked), (0, 1), needs_edge=False)
    assert found.fewest
    assert len(found.edges) <= 4


def test_up_to_thirty_agents_all_leaders_are_tried() -> None:
    places = np.random.default_rng(4).normal(size=(31, 2))
    found = free_remedy(Field.open(places[:30]), needs_edge=False)
    assert found is not None
    assert (found.leaders, found.edges) == ((0, 1), ())
    assert free_remedy(Field.open(places), needs_edge=False) is None


def test_two_agents_in_one_place_cannot_be_told_apart() -> None:
    places = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    with pytest.raises(ValueError, match="two agents that coincide cannot be told apart"):
        remedy(Field.open(places), (0, 1), needs_edge=False)
