"""Targets from angles: the recursion of Lemma 1 and the angles that it must refuse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import AngleSet, SensingGraph, end_configuration, random_target, target_from_angles

TRIANGLE = SensingGraph(np.array([[0, 1]]))
AT_1_AND_2 = AngleSet(np.array([[0, 2, 1], [1, 0, 2]]))  # a_i and a_j of the triangle (1, 2, 3)


def from_degrees(*degrees: float, angles: AngleSet = AT_1_AND_2):
    return target_from_angles(TRIANGLE, angles, np.radians(degrees))


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 40))
def test_round_trip_from_angles_to_positions_to_angles(seed: int, n: int) -> None:
    target = random_target(n, np.random.default_rng(seed))
    angles = AngleSet.of_followers(target.graph)
    values = angles.measure(target.positions)
    rebuilt = target_from_angles(target.graph, angles, values)
    np.testing.assert_allclose(np.abs(angles.errors(rebuilt.positions, values)), 0.0, atol=1e-9)
    aligned = end_configuration(target, *rebuilt.positions[:2])
    np.testing.assert_allclose(rebuilt.positions, aligned, atol=1e-9 * max(1.0, np.abs(aligned).max()))


@given(
    seed=st.integers(0, 2**32 - 1),
    pair=st.sampled_from([(0, 1), (1, 2), (0, 2)]),
    reverse=st.tuples(st.booleans(), st.booleans()),
)
def test_any_two_corners_named_in_either_direction_give_the_same_shape(
    seed: int, pair: tuple[int, int], reverse: tuple[bool, bool]
) -> None:
    target = random_target(3, np.random.default_rng(seed))
    corners = [(0, 2, 1), (1, 0, 2), (2, 1, 0)]
    chosen = [corners[c] for c in pair]
    triples = [(v, b, a) if flip else (v, a, b) for (v, a, b), flip in zip(chosen, reverse, strict=True)]
    angles = AngleSet(np.array(triples))
    rebuilt = target_from_angles(target.graph, angles, angles.measure(target.positions))
    np.testing.assert_allclose(rebuilt.interior_angles, target.interior_angles, atol=1e-9)


def test_the_papers_printed_angles_give_the_papers_shape() -> None:
    graph = SensingGraph(np.array([[0, 1], [1, 2], [0, 3], [0, 3]]))
    named = [(1, 2, 3), (2, 1, 3), (3, 2, 4), (4, 2, 3), (4, 1, 5), (5, 1, 4), (4, 1, 6), (6, 1, 4)]
    printed = [90.0, 315.0, 45.0, 270.0, 63.43, 306.87, 296.57, 53.13]
    target = target_from_angles(graph, AngleSet(np.array(named) - 1), np.radians(printed))
    exact = [(0, 0), (1, 0), (0, 1), (1, 1), (1.5, -0.5), (-0.5, 1.5)]
    np.testing.assert_allclose(target.positions, exact, atol=5e-4)


def test_angles_that_leave_nothing_for_the_third_cannot_close_the_triangle() -> None:
    with pytest.raises(ValueError, match=r"triangle \(1, 2, 3\) cannot close it"):
        from_degrees(120.0, 70.0)


def test_angles_that_turn_opposite_ways_have_a_wrong_orientation() -> None:
    with pytest.raises(ValueError, match=r"triangle \(1, 2, 3\) have a wrong orientation"):
        from_degrees(60.0, 300.0)


@pytest.mark.parametrize("flat", [0.0, 180.0, 360.0])
def test_a_flat_angle_makes_the_triangle_degenerate(flat: float) -> None:
    with pytest.raises(ValueError, match=r"triangle \(1, 2, 3\) is degenerate"):
        from_degrees(flat, 60.0)


def test_one_angle_does_not_fix_a_triangle() -> None:
    with pytest.raises(ValueError, match=r"triangle \(1, 2, 3\) has 1 of the 2 angles"):
        from_degrees(60.0, angles=AngleSet(np.array([[0, 2, 1]])))


def test_a_third_angle_must_agree_with_the_first_two() -> None:
    three = AngleSet(np.array([[0, 2, 1], [1, 0, 2], [2, 1, 0]]))
    assert from_degrees(60.0, 60.0, 60.0, angles=three).graph.n == 3
    with pytest.raises(ValueError, match="cannot close it"):
        from_degrees(60.0, 60.0, 61.0, angles=three)


def test_a_corner_given_twice_must_agree() -> None:
    twice = AngleSet(np.array([[0, 2, 1], [0, 1, 2], [1, 0, 2]]))
    assert from_degrees(60.0, 300.0, 60.0, angles=twice).graph.n == 3
    with pytest.raises(ValueError, match="contradicts"):
        from_degrees(60.0, 299.0, 60.0, angles=twice)


def test_an_angle_across_triangles_is_refused() -> None:
    graph = SensingGraph(np.array([[0, 1], [0, 1]]))
    with pytest.raises(ValueError, match=r"alpha\(1;3,4\) belongs to no follower's triangle"):
        target_from_angles(graph, AngleSet(np.array([[0, 2, 3]])), [1.0])


@pytest.mark.parametrize(("surplus", "closes"), [(2.9e-6, True), (3.1e-6, False), (-2.9e-6, True), (-3.1e-6, False)])
def test_three_angles_may_miss_half_a_turn_by_the_tolerance_of_each(surplus: float, closes: bool) -> None:
    graph = SensingGraph(np.array([[0, 1]]))
    angles = AngleSet(np.array([(0, 2, 1), (1, 0, 2), (2, 1, 0)]))
    values = angles.measure(np.array([[0.0, 0.0], [1.0, 0.0], [0.2, 0.9]]))
    values[1] += surplus
    if closes:
        target_from_angles(graph, angles, values, tolerance=1e-6)
    else:
        with pytest.raises(ValueError, match="cannot close it"):
            target_from_angles(graph, angles, values, tolerance=1e-6)
