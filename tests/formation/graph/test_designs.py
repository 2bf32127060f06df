"""What is designed is the best of its kind: by brute force over few agents."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import LAWS, DirectedGraph, Framework, random_target
from formation.audit import Subject
from formation.graph import designs
from formation.graph.conditions import CONDITIONS
from formation.graph.designs import angle_rate, design
from formation.plane import as_complex, as_vectors

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=15)


def bare(places: np.ndarray) -> Framework:
    """A target whose graph fulfils next to nothing."""
    return Framework(DirectedGraph(len(places), np.array([[1, 0]])), places)


def drawn(seed: int, n: int = 6) -> tuple[Framework, np.ndarray]:
    places = random_target(n, np.random.default_rng(seed), min_separation=0.1).positions
    return bare(places), as_complex(places)


def sensed(formation: Framework) -> list[list[int]]:
    return [formation.graph.neighbours(k).tolist() for k in range(formation.graph.n)]  # type: ignore[attr-defined]


def roundness(a: complex, b: complex, c: complex) -> float:
    """The height of a triangle on its longest side, over that side."""
    sides = sorted([abs(a - b), abs(b - c), abs(c - a)])
    half = sum(sides) / 2.0
    return 2.0 * float(np.sqrt(half * np.prod([half - side for side in sides]))) / sides[2] ** 2


def weights(p: np.ndarray, seen: list[int], k: int) -> np.ndarray:
    """The real weights, of sum 1, with which three places give another one."""
    z = p[seen]
    return np.linalg.inv(np.stack([np.ones(3), z.real, z.imag])) @ [1.0, p[k].real, p[k].imag]


@EXAMPLES
@given(seed=SEEDS)
def test_each_agent_of_a_laman_graph_joins_the_edge_with_which_it_is_roundest(seed: int) -> None:
    formation, p = drawn(seed)
    graph = sensed(design("triangulated Laman", formation))
    edges = {(0, 1)}
    for k in range(2, 6):
        joined = [i for i in graph[k] if i < k]
        best = max(edges, key=lambda edge: roundness(p[edge[0]], p[edge[1]], p[k]))
        assert joined == sorted(best)
        edges |= {(joined[0], k), (joined[1], k)}


@pytest.mark.parametrize("condition", ["leader-first-follower", "minimally persistent", "rooted"])
@EXAMPLES
@given(seed=SEEDS)
def test_each_agent_senses_the_two_before_it_with_which_it_is_roundest(condition: str, seed: int) -> None:
    formation, p = drawn(seed)
    if condition == "rooted":
        formation = Framework(DirectedGraph(6, np.empty((0, 2), dtype=int)), formation.positions)
    graph = sensed(design(condition, formation))
    assert graph[:2] == [[], [0]]
    for k in range(2, 6):
        assert graph[k] == list(max(combinations(range(k), 2), key=lambda m: roundness(p[m[0]], p[m[1]], p[k])))


@EXAMPLES
@given(seed=SEEDS)
def test_each_agent_senses_the_three_before_it_whose_weights_are_smallest(seed: int) -> None:
    formation, p = drawn(seed)
    graph, both = sensed(design("three before", formation)), sensed(design("universally rigid", formation))
    assert graph[:3] == [[], [], []]
    assert [set(both[k]) >= {m for m in range(3) if m != k} for k in range(3)] == [True] * 3
    for k in range(3, 6):
        options = [list(t) for t in combinations(range(k), 3) if roundness(*p[list(t)]) > 1e-3]
        assert graph[k] in options
        least = min(float(np.abs(weights(p, t, k)).sum()) for t in options)
        assert np.abs(weights(p, graph[k], k)).sum() == pytest.approx(least)
        assert [i for i in both[k] if i < k] == graph[k]


def test_three_before_that_are_nearly_on_one_line_are_left_and_all_on_one_line_are_refused() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, 0.5]])
    with pytest.raises(ValueError, match="all agents before agent 4 are collinear in the target"):
        design("three before", bare(line))
    line[2, 1] = 1e-3
    with pytest.raises(ValueError, match="all agents before agent 4 are collinear in the target"):
        design("three before", bare(line))
    line[2, 1] = 5e-3
    assert sensed(design("three before", bare(line)))[3] == [0, 1, 2]


def test_a_chain_leads_from_agent_2_through_all_others_to_agent_1() -> None:
    formation = bare(np.random.default_rng(0).normal(size=(5, 2)))
    assert sensed(design("two-rooted", formation)) == [[], [], [1, 3], [2, 4], [0, 3]]


def test_everybody_before_or_everybody_is_sensed_where_that_is_asked() -> None:
    empty = Framework(DirectedGraph(4, np.array([[0, 1]])), np.random.default_rng(0).normal(size=(4, 2)))
    assert sensed(design("ordered", empty)) == [[], [0], [0, 1], [0, 1, 2]]
    three = Framework(DirectedGraph(3, np.array([[0, 1]])), np.random.default_rng(0).normal(size=(3, 2)))
    assert sensed(design("triangle", three)) == [[1, 2], [0, 2], [0, 1]]


@pytest.mark.parametrize("condition", ["rigid", "bearing rigid", "undirected", "triangulated"])
def test_the_edges_that_are_there_are_sensed_from_both_ends_and_no_others_where_that_does(condition: str) -> None:
    target = random_target(6, np.random.default_rng(1))
    wanted = {frozenset(edge) for edge in target.graph.formation_edges.tolist()}
    designed = design(condition, target)
    assert {frozenset(edge) for edge in designed.graph.edges.tolist()} == wanted
    assert len(designed.graph.edges) == 2 * len(wanted)
    loose = bare(target.positions)
    assert sensed(design(condition, loose)) == sensed(design("triangulated Laman", loose))


def test_what_fulfils_its_condition_is_left_alone_and_what_nobody_designs_is_said() -> None:
    target = random_target(5, np.random.default_rng(1))
    assert design("leader-first-follower", target) is target
    assert design("any", target) is target
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(designs, "DESIGNS", {})
        with pytest.raises(ValueError, match="nothing designs a graph that is triangle"):
            design("triangle", target)


@EXAMPLES
@given(seed=SEEDS)
def test_the_rate_of_an_agent_by_bisectors_is_that_of_its_linearised_law(seed: int) -> None:
    rng = np.random.default_rng(seed)
    seen = np.exp(2j * np.pi * (np.arange(3) / 3.0 + rng.uniform(-0.1, 0.1, 3))) * rng.uniform(0.5, 2.0, 3)
    places = as_vectors(np.append(seen, 0.0))
    edges = [(k, i) for k in range(3) for i in range(3) if i != k] + [(3, 0), (3, 1), (3, 2)]
    formation = Framework(DirectedGraph(4, np.array(edges)), places)
    subject = Subject(LAWS["bisector"](formation), formation)  # type: ignore[call-arg]
    slope, h = np.empty((2, 2)), 1e-5
    for column in range(2):
        move = np.zeros((4, 2))
        move[3, column] = h
        slope[:, column] = (subject(places + move) - subject(places - move))[3] / (2.0 * h)
    assert angle_rate(seen) == pytest.approx(-np.linalg.eigvals(slope).real.max(), rel=1e-5)


def grown(p: np.ndarray, start: tuple[int, ...]) -> tuple[float, dict[int, tuple[int, ...]]]:
    """A graph for signed angles from three agents: again and again the agent that three placed ones serve best."""
    placed, slowest, found = set(start), np.inf, {}
    while len(placed) < len(p):
        rate, k, seen = max(
            (angle_rate(p[list(t)] - p[k]), k, t)
            for k in set(range(len(p))) - placed
            for t in combinations(sorted(placed), 3)
        )
        slowest, found[k] = min(slowest, rate), seen
        placed.add(k)
    return slowest, found


@settings(max_examples=6)
@given(seed=SEEDS)
def test_a_graph_for_signed_angles_grows_from_the_three_from_which_its_slowest_agent_is_fastest(seed: int) -> None:
    formation, p = drawn(seed)
    designed = design("signed angles", formation)
    graph = sensed(designed)
    rate = min(angle_rate(p[seen] - p[k]) for k, seen in enumerate(graph) if len(seen) == 3)
    starts = [t for t in combinations(range(6), 3) if roundness(*p[list(t)]) > 0.05]
    best, found = max((grown(p, start) for start in starts), key=lambda each: each[0])
    assert rate == pytest.approx(best)
    assert {k: tuple(seen) for k, seen in enumerate(graph) if len(seen) == 3} == found


def test_of_many_agents_the_nearest_eight_are_weighed_from_as_many_starts_as_choices_allow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    formation, p = drawn(2, 11)
    placed = [0, 1, 2, 3, 5, 6, 7, 8, 9, 10]
    nearest = sorted(sorted(placed, key=lambda i: abs(p[i] - p[4]))[:8])
    assert designs._near(p, placed, 4) == nearest
    assert designs._near(p, placed[:8], 4) == placed[:8]
    monkeypatch.setattr(designs, "MOST_CHOICES", 2 * 56 * 11**2)  # two starts, 56 threes of eight for each agent
    starts = [t for t in combinations(range(11), 3) if roundness(*p[list(t)]) > 0.05]
    graph = sensed(design("signed angles", formation))
    assert tuple(k for k, seen in enumerate(graph) if len(seen) == 2) in starts[:2]
    monkeypatch.setattr(designs, "MOST_CHOICES", 1)
    graph = sensed(design("signed angles", formation))
    assert tuple(k for k, seen in enumerate(graph) if len(seen) == 2) == starts[0]


def test_agents_on_one_line_have_no_graph_for_signed_angles() -> None:
    with pytest.raises(ValueError, match="all agents are collinear in the target"):
        design("signed angles", bare(np.arange(5.0)[:, None] * [[1.0, 0.5]]))


@pytest.mark.parametrize("condition", [condition for condition in CONDITIONS if condition not in ("any", "triangle")])
def test_every_condition_has_a_design_that_fulfils_it_from_next_to_nothing(condition: str) -> None:
    formation, _ = drawn(5)
    CONDITIONS[condition](design(condition, formation))
