"""Signed angles: range, sense, invariance, names."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from formation import AngleSet, SensingGraph, Similarity, rotation, signed_angle, wrap

coordinates = st.floats(-10.0, 10.0)
points = st.tuples(coordinates, coordinates).map(np.array)
radians = st.floats(-np.pi, np.pi)


def apart(*corners: np.ndarray) -> bool:
    """Whether the corners keep a distance at which angles are well conditioned."""
    return all(np.linalg.norm(a - b) > 1e-2 for k, a in enumerate(corners) for b in corners[:k])


@given(points, points, points)
def test_an_angle_lies_in_one_turn(v: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
    assume(not (v == a).all() and not (v == b).all())
    angle = signed_angle(v, a, b)
    assert np.isnan(angle) or 0.0 <= angle < 2.0 * np.pi


@given(points, radians, st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.0, 2.0 * np.pi - 1e-9))
def test_an_angle_is_the_counter_clockwise_turn_from_the_first_ray_to_the_second(
    v: np.ndarray, first: float, near: float, far: float, turn: float
) -> None:
    a = v + near * np.array([np.cos(first), np.sin(first)])
    b = v + far * np.array([np.cos(first + turn), np.sin(first + turn)])
    assert wrap(signed_angle(v, a, b) - turn) == pytest.approx(0.0, abs=1e-11)


def test_a_quarter_turn_to_the_left_is_90_degrees_and_to_the_right_270() -> None:
    assert np.degrees(signed_angle([0, 0], [1, 0], [0, 1])) == pytest.approx(90.0)
    assert np.degrees(signed_angle([0, 0], [0, 1], [1, 0])) == pytest.approx(270.0)


@given(points, points, points)
def test_the_angles_between_two_rays_both_ways_add_up_to_one_turn(v: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
    assume(apart(v, a, b))
    """One turn, or none where both rays point the same way: rounding may make a hair's breadth of that a whole turn."""
    there, back = signed_angle(v, a, b), signed_angle(v, b, a)
    assert min(there, back) >= 0.0
    assert wrap(there + back) == pytest.approx(0.0, abs=1e-12)
    if min(abs(wrap(there)), abs(wrap(back))) > 1e-12:
        assert there + back == pytest.approx(2.0 * np.pi, abs=1e-12)


@given(points, points, points, st.floats(0.1, 10.0), radians, points)
def test_similarities_keep_angles_and_reflections_turn_them_round(
    v: np.ndarray, a: np.ndarray, b: np.ndarray, scale: float, theta: float, xi: np.ndarray
) -> None:
    assume(apart(v, a, b))
    angle = signed_angle(v, a, b)
    moved = Similarity(scale, theta, tuple(xi))(np.array([v, a, b]))
    assert wrap(signed_angle(*moved) - angle) == pytest.approx(0.0, abs=1e-9)
    mirrored = np.array([v, a, b]) * [1.0, -1.0]
    assert wrap(signed_angle(*mirrored) + angle) == pytest.approx(0.0, abs=1e-9)


def test_no_angle_exists_at_a_coinciding_vertex() -> None:
    assert np.isnan(signed_angle([1, 1], [1, 1], [0, 0]))
    assert np.isnan(signed_angle([1, 1], [0, 0], [1, 1]))


def test_a_hair_below_the_first_ray_is_not_a_whole_turn() -> None:
    assert 0.0 <= signed_angle([0, 0], [1, 0], [1, -1e-320]) < 2.0 * np.pi
    assert 0.0 <= signed_angle([0, 0], [1, 0], [1, -1e-17]) < 2.0 * np.pi


@given(st.floats(-1e3, 1e3))
def test_wrapping_changes_an_angle_by_whole_turns_into_the_half_open_interval(angle: float) -> None:
    wrapped = wrap(angle)
    assert -np.pi < wrapped <= np.pi
    assert (angle - wrapped) / (2.0 * np.pi) == pytest.approx(round((angle - wrapped) / (2.0 * np.pi)), abs=1e-12)


def test_wrapping_keeps_pi_and_turns_minus_pi_round() -> None:
    assert wrap(np.pi) == np.pi
    assert wrap(-np.pi) == np.pi


def test_wrapping_is_exact_near_zero() -> None:
    assert wrap(1e-300) == pytest.approx(0.0, abs=5e-16)


@pytest.mark.parametrize("triple", [(0, 0, 1), (0, 1, 1), (1, 0, 1)])
def test_an_angle_names_three_distinct_agents(triple: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="three distinct agents"):
        AngleSet(np.array([triple]))


def test_an_angle_names_agents_from_1_on() -> None:
    with pytest.raises(ValueError, match=r"alpha\(0;2,3\) names an agent below 1"):
        AngleSet(np.array([[-1, 1, 2]]))


def test_names_are_vertex_first_and_number_agents_from_1() -> None:
    assert AngleSet(np.array([[2, 1, 3]])).names == ["alpha(3;2,4)"]


def test_the_angles_of_the_followers_fix_every_triangle() -> None:
    graph = SensingGraph.random(7, np.random.default_rng(0))
    angles = AngleSet.of_followers(graph)
    assert len(angles) == 2 * len(graph.triangles)
    assert {tuple(sorted(t)) for t in angles.triples.tolist()} == {tuple(sorted(t)) for t in graph.triangles.tolist()}


def test_measuring_a_batch_equals_measuring_each_configuration() -> None:
    rng = np.random.default_rng(1)
    angles = AngleSet.of_followers(SensingGraph.random(6, rng))
    batch = rng.normal(size=(3, 4, 6, 2))
    assert (angles.measure(batch)[1, 2] == angles.measure(batch[1, 2])).all()


def test_an_angle_error_is_signed_and_takes_the_short_way_round() -> None:
    angles = AngleSet(np.array([[0, 1, 2]]))
    corners = np.array([[0.0, 0.0], [1.0, 0.0], rotation(np.radians(359.0)) @ [1.0, 0.0]])
    assert np.degrees(angles.errors(corners, [np.radians(1.0)])) == pytest.approx([-2.0])
