"""What the paper's statements need added, where no other test says it: docs/paper.md lists them all."""

import numpy as np
import pytest

from formation import AngleLaw, SensingGraph, TargetFormation, follower_gains
from formation.analysis.cascade import Cascade
from formation.plane import Complex, Real, as_complex


def ends(target: TargetFormation, mirrored: frozenset[int] = frozenset()) -> Complex:
    """(n,) where the followers rest about agents 1 and 2 of p*, those in ``mirrored`` (rows) in mirrored frames."""
    places = list(as_complex(target.positions[:2]))
    for k, ((i, j), gains) in enumerate(zip(target.graph.neighbours, follower_gains(target), strict=True), start=2):
        a, b = np.conj(gains) if k in mirrored else gains
        places.append((a * places[i] + b * places[j]) / (a + b))
    return np.array(places)


def test_over_the_sensing_edges_there_are_four_triangles_and_over_the_formation_edges_six(
    paper: TargetFormation,
) -> None:
    def triangles(edges: np.ndarray) -> int:
        joined = {frozenset(edge) for edge in edges.tolist()}
        corners = [(a, b, c) for a in range(6) for b in range(a) for c in range(b)]
        return sum({frozenset((a, b)), frozenset((b, c)), frozenset((a, c))} <= joined for a, b, c in corners)

    assert len(paper.graph.triangles) == 4
    assert triangles(paper.graph.formation_edges) > len(paper.graph.triangles) > triangles(paper.graph.edges)


def test_shape_control_leaves_the_edge_from_the_first_follower_to_the_leader_idle(paper: TargetFormation) -> None:
    law, edges = AngleLaw(paper), paper.graph.edges
    relative: Real = paper.positions[edges[:, 1]] - paper.positions[edges[:, 0]] + 0.1
    asked = law(relative)
    relative[0] = np.nan
    np.testing.assert_array_equal(law(relative), asked)


def test_all_agents_in_one_place_satisfy_every_constraint_and_have_no_shape(paper: TargetFormation) -> None:
    """Lemma 1 needs q_1 != q_2."""
    np.testing.assert_array_equal(paper.residual(np.zeros((6, 2))), 0.0)


def test_a_mirrored_robot_sends_its_followers_to_wrong_places(paper: TargetFormation) -> None:
    right = as_complex(paper.positions)
    np.testing.assert_allclose(ends(paper), right, atol=1e-12)
    third = ends(paper, frozenset({2}))
    np.testing.assert_allclose(third[3:], right[0], atol=1e-12)  # 4, 5 and 6 all at the leader's place
    fifth = ends(paper, frozenset({4}))
    np.testing.assert_allclose(fifth[4], right[5], atol=1e-12)  # on agent 6
    np.testing.assert_allclose(fifth[[2, 3, 5]], right[[2, 3, 5]], atol=1e-12)


def test_the_double_mode_of_the_maneuver_has_two_directions_in_the_papers_shape_and_one_in_others(
    paper: TargetFormation,
) -> None:
    def directions(target: TargetFormation) -> int:
        matrix = Cascade.of(target, 1.0).matrix
        return 5 - int(np.linalg.matrix_rank(matrix + np.eye(5), 1e-9))

    assert directions(paper) == 2
    places = paper.positions.copy()
    places[2] = [0.3, 1.2]
    places[3] = places[2] + np.array([[0.0, -1.0], [1.0, 0.0]]) @ (places[2] - places[1]) * 0.7
    other = TargetFormation(SensingGraph(np.array([[0, 1], [1, 2], [0, 3], [0, 3]])), places)
    assert Cascade.of(other).rates[2] < 1.0
    right = places.copy()
    right[3] = 0.5 * (places[1] + places[2]) + 0.5 * np.array([[0.0, -1.0], [1.0, 0.0]]) @ (places[2] - places[1])
    other = TargetFormation(other.graph, right)
    assert Cascade.of(other).rates[2] == pytest.approx(1.0)
    assert directions(other) == 1
