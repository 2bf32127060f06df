"""Each condition on a graph lets pass what its docstring lets pass, and names what breaks it otherwise."""

import re
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import DirectedGraph, Framework
from formation.graph.conditions import CONDITIONS, reached
from formation.graph.stress import equilibrium_stress

PENTAGON = np.array([[0.0, 0.0], [1.9, 0.1], [2.2, 1.7], [0.8, 2.6], [-0.7, 1.4]])
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def both(*pairs: tuple[int, int]) -> list[tuple[int, int]]:
    """Edges between agents, by number, in both directions."""
    return [*pairs, *((b, a) for a, b in pairs)]


def framework(edges: list[tuple[int, int]], n: int = 5, places: np.ndarray = PENTAGON) -> Framework:
    """Edges (observer, observed) by number."""
    return Framework(DirectedGraph(n, np.array(edges, dtype=np.intp).reshape(-1, 2) - 1), places[:n])


FAN = both((1, 2), (1, 3), (2, 3), (1, 4), (3, 4), (1, 5), (4, 5))
"""A triangulated Laman graph of five."""

PASSES = {
    "rooted": [[(2, 1), (3, 2), (4, 3), (5, 4)], [(2, 3), (3, 1), (4, 1), (5, 2)]],
    "two-rooted": [[(3, 1), (3, 2), (4, 3), (4, 5), (5, 1), (5, 4)], [(3, 1), (3, 4), (4, 3), (4, 2), (5, 1), (5, 2)]],
    "undirected": [both((1, 2), (2, 3), (3, 4), (4, 5)), FAN],
    "rigid": [FAN, both(*combinations(range(1, 6), 2))],
    "bearing rigid": [FAN],
    "universally rigid": [both(*combinations(range(1, 6), 2))],
    "triangulated": [
        FAN,
        both(*combinations(range(1, 6), 2)),
        both((4, 5), (3, 4), (3, 5), (2, 3), (2, 4), (1, 2), (1, 3)),
    ],
    "triangulated Laman": [FAN],
    "minimally persistent": [[(2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (5, 1), (5, 4)]],
    "ordered": [
        [(2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (5, 1), (5, 2), (5, 4)],
        [(3, 1), (3, 2), (4, 1), (4, 2), (5, 2), (5, 3)],
    ],
    "three before": [
        [(2, 1), (3, 1), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 4)],
        [(4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 3), (5, 4)],
    ],
    "signed angles": [
        [*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 3), (5, 1), (5, 3), (5, 4)],
        [*both((2, 4), (4, 5), (2, 5)), (1, 2), (1, 4), (1, 5), (3, 1), (3, 4), (3, 5)],
    ],
}


@pytest.mark.parametrize(
    ("condition", "edges"), [(condition, edges) for condition, graphs in PASSES.items() for edges in graphs]
)
def test_what_has_the_property_passes(condition: str, edges: list[tuple[int, int]]) -> None:
    CONDITIONS[condition](framework(edges))


TWO = "has no two separate chains of sensing edges to agents 1 and 2"
SENSE_EACH_OTHER = "expected three agents that sense each other and nobody else"
LOOSE = "6 of 7 constraints are independent, agent 5 can move against the others"

BROKEN = {
    "undirected": [
        (
            [*both((1, 2), (2, 3)), (3, 4), *both((4, 5))],
            "edge (3, 4) is sensed from one end; agent 4 must sense it too",
        ),
        (both((1, 2), (2, 3), (4, 5)), "agent 4 is not connected to agent 1"),
    ],
    "rooted": [([(2, 1), (3, 2), (4, 5), (5, 4)], "no chain of sensing edges leads from agent 4 to agent 1")],
    "two-rooted": [
        ([(3, 1), (3, 2), (4, 3), (5, 1), (5, 2)], f"agent 4 {TWO}, none is left without agent 3"),
        ([(3, 1), (3, 2), (4, 5), (5, 4)], f"agent 4 {TWO}"),
        ([(3, 2), (4, 1), (4, 2), (5, 1), (5, 2)], f"agent 3 {TWO}, none is left without agent 2"),
    ],
    "triangulated": [
        (both((1, 2), (2, 3), (3, 4), (4, 5), (5, 1)), "it has no triangle"),
        (
            both((1, 2), (1, 3), (2, 3), (3, 4), (3, 5), (4, 5)),
            "no chain of triangles, each sharing an edge with the next, reaches agent 4",
        ),
        ([*FAN, (2, 4)], "edge (2, 4) is sensed from one end; agent 4 must sense it too"),
    ],
    "triangulated Laman": [([*FAN, *both((2, 4))], "it has 8 edges, expected 2n - 3 = 7")],
    "minimally persistent": [
        ([(2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (4, 2), (5, 1)], "agent 4 senses 3 agents, expected at most 2"),
        ([(2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (5, 1)], "it has 6 edges, expected 2n - 3 = 7"),
        ([(1, 2), (2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (5, 1)], f"the framework is not rigid: {LOOSE}"),
    ],
    "ordered": [
        (
            [(3, 1), (3, 2), (4, 5), (4, 1), (5, 1), (5, 2)],
            "agent 4 senses agent 5; an agent may sense only agents before it",
        ),
        ([(2, 1), (3, 1), (3, 2), (4, 1), (5, 1), (5, 2)], "agent 4 senses 1 agents, expected at least 2"),
        ([(2, 1), (3, 1), (4, 1), (4, 2), (5, 1), (5, 2)], "agent 3 senses 1 agents, expected at least 2"),
    ],
    "three before": [
        (
            [(2, 1), (3, 1), (3, 2), (4, 1), (4, 3), (5, 1), (5, 2), (5, 3)],
            "agent 4 senses 2 agents, expected at least 3",
        ),
    ],
    "triangle": [(FAN, "expected 3 agents, got 5")],
    "signed angles": [
        ([*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 3), (5, 1)], "agent 5 senses 1 agents, expected 2 or 3"),
        (
            [*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 3), (5, 4)],
            "agent 5 senses 4 agents, expected 2 or 3",
        ),
        ([*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2)], SENSE_EACH_OTHER),
        (
            [(1, 2), (1, 4), (2, 1), (2, 3), (3, 1), (3, 2), (4, 1), (4, 2), (4, 3), (5, 1), (5, 2), (5, 3)],
            SENSE_EACH_OTHER,
        ),
        (
            [*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 5), (5, 1), (5, 2), (5, 4)],
            "agent 4 does not sense three agents that come before it: there is a cycle",
        ),
    ],
}


@pytest.mark.parametrize(
    ("condition", "edges", "message"),
    [(condition, *case) for condition, cases in BROKEN.items() for case in cases],
)
def test_what_breaks_a_condition_is_named(condition: str, edges: list[tuple[int, int]], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        CONDITIONS[condition](framework(edges))


def test_three_agents_see_each_other_or_the_missing_edge_is_named() -> None:
    CONDITIONS["triangle"](framework(both((1, 2), (1, 3), (2, 3)), 3))
    with pytest.raises(ValueError, match=re.escape("edge (3, 2) is sensed from one end; agent 2 must sense it too")):
        CONDITIONS["triangle"](framework([*both((1, 2), (1, 3)), (3, 2)], 3))
    with pytest.raises(ValueError, match="some two agents do not sense each other"):
        CONDITIONS["triangle"](framework(both((1, 2), (1, 3)), 3))


@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
@pytest.mark.parametrize(("off", "passes"), [(0.0, False), (1e-4, False), (0.05, True)])
def test_an_agent_on_one_circle_with_the_three_that_it_senses_is_told_whatever_the_size(
    size: float, off: float, passes: bool
) -> None:
    angles = np.array([0.1, 1.9, 4.0, 5.2])
    places = size * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    places[3] *= 1.0 + off
    formation = framework([*both((1, 2), (1, 3), (2, 3)), (4, 1), (4, 2), (4, 3)], 4, places)
    if passes:
        CONDITIONS["signed angles"](formation)
    else:
        with pytest.raises(ValueError, match="agent 4 is on one circle with those that it senses"):
            CONDITIONS["signed angles"](formation)


@settings(max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 8))
def test_who_is_reached_is_who_a_power_of_the_graphs_matrix_leads_to_a_root(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    matrix = rng.random((n, n)) < 0.25
    roots = set(np.flatnonzero(rng.random(n) < 0.4).tolist())
    leads = np.linalg.matrix_power(np.eye(n, dtype=int) + matrix, n) > 0
    expected = [bool(set(np.flatnonzero(leads[k]).tolist()) & roots) for k in range(n)]
    assert reached(n, np.argwhere(matrix), roots).tolist() == expected


@pytest.mark.parametrize("word", ["rigid", "bearing rigid"])
def test_the_agent_that_is_loosest_is_named(word: str) -> None:
    hanging = both((1, 2), (1, 3), (2, 3), (1, 4), (2, 4), (4, 5))
    message = f"the framework is not {word}: {LOOSE}"
    with pytest.raises(ValueError, match=re.escape(message)):
        CONDITIONS[word](framework(hanging))


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_of_a_rod_the_far_end_is_loose_wherever_the_framework_is(turn: float) -> None:
    """Alone, the motions that nothing forbids look as if others moved too: turns about the origin, scalings, shifts."""
    places = (PENTAGON.view(complex) * np.exp(1j * turn)).view(float) + [30.0, -20.0]
    for word in ("rigid", "bearing rigid"):
        with pytest.raises(ValueError, match="agent 5 can move against the others"):
            CONDITIONS[word](framework(both((1, 2), (1, 3), (2, 3), (1, 4), (2, 4), (4, 5)), 5, places))


def test_a_square_is_rigid_by_bearings_with_a_diagonal_only() -> None:
    frame = both((1, 2), (2, 3), (3, 4), (4, 1))
    for word in ("rigid", "bearing rigid"):
        with pytest.raises(ValueError, match="4 of 5 constraints are independent"):
            CONDITIONS[word](framework(frame, 4, SQUARE))
        CONDITIONS[word](framework([*frame, *both((1, 3))], 4, SQUARE))


def stress_matrix(formation: Framework, stress: np.ndarray) -> np.ndarray:
    n = formation.graph.n
    matrix = np.zeros((n, n))
    for (k, i), s in zip(formation.graph.edges.tolist(), stress, strict=True):
        matrix[k, i] = -s
    return matrix - np.diag(matrix.sum(axis=1))


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(4, 7))
def test_a_stress_is_in_equilibrium_and_leaves_affine_images_free_and_no_mode_slower_than_1(seed: int, n: int) -> None:
    places = np.random.default_rng(seed).normal(size=(n, 2))
    formation = framework(both(*combinations(range(1, n + 1), 2)), n, places)
    matrix = stress_matrix(formation, equilibrium_stress(formation))
    scale = np.abs(matrix).max()
    np.testing.assert_allclose(matrix, matrix.T)
    np.testing.assert_allclose(matrix @ np.column_stack([places, np.ones(n)]), 0.0, atol=1e-9 * scale)
    modes = np.linalg.eigvalsh(matrix)
    np.testing.assert_allclose(modes[:3], 0.0, atol=1e-9 * scale)
    assert modes[3] == pytest.approx(1.0)


def test_a_framework_without_a_stress_or_with_negative_modes_only_is_not_universally_rigid() -> None:
    with pytest.raises(ValueError, match="its edges carry no stress"):
        CONDITIONS["universally rigid"](framework(FAN))
    with pytest.raises(ValueError, match="its edges carry no stress"):
        CONDITIONS["universally rigid"](framework(both((1, 2), (1, 3), (2, 3)), 3))
    wheel = both((1, 2), (2, 3), (3, 4), (4, 1), (5, 1), (5, 2), (5, 3), (5, 4))
    rim = [[0.0, 0.0], [1.0, 0.1], [1.1, 1.0], [0.0, 1.2]]
    with pytest.raises(ValueError, match="no stress without negative modes was found"):
        CONDITIONS["universally rigid"](framework(wheel, 5, np.array([*rim, [0.5, 0.4]])))
    CONDITIONS["universally rigid"](framework(wheel, 5, np.array([*rim, [3.0, 0.4]])))
