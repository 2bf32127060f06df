"""Laws of the first follower: what each steers and what each leaves alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation.analysis.first_follower import motion
from formation.laws.first_follower import COMPASS_FREE, EDGE_LAWS, bearing, displacement, distance, spiral, stationary

vectors = st.builds(lambda r, angle: np.asarray(r * np.exp(1j * angle)), st.floats(0.05, 3.0), st.floats(-np.pi, np.pi))
turns = st.floats(-np.pi, np.pi).map(lambda angle: np.exp(1j * angle))


@given(vectors, vectors)
def test_the_stationary_law_stands_still(e: np.ndarray, delta: np.ndarray) -> None:
    assert stationary(e, delta) == 0.0


@given(vectors, vectors)
def test_the_displacement_law_heads_straight_for_the_commanded_place(e: np.ndarray, delta: np.ndarray) -> None:
    assert e + displacement(e, delta) == pytest.approx(delta)


@given(vectors, vectors)
def test_the_distance_law_moves_along_the_ray_and_shrinks_the_length_error(e: np.ndarray, delta: np.ndarray) -> None:
    u = distance(e, delta)
    assert (u * np.conj(e)).imag == pytest.approx(0.0, abs=1e-10)
    assert (u * np.conj(e)).real * (abs(e) - abs(delta)) <= 0.0
    assert abs(u) == pytest.approx(abs(abs(e) ** 2 - abs(delta) ** 2) * abs(e), abs=1e-12)


@given(vectors, vectors)
def test_the_bearing_law_moves_across_the_ray_and_towards_the_commanded_bearing(
    e: np.ndarray, delta: np.ndarray
) -> None:
    u = bearing(e, delta)
    assert (u * np.conj(e)).real == pytest.approx(0.0, abs=1e-12)
    assert (u * np.conj(delta)).real >= -1e-12
    assert abs(u) == pytest.approx(abs(np.sin(np.angle(e * np.conj(delta)))), abs=1e-12)


@given(vectors, vectors)
def test_every_law_rests_where_its_command_is_met(e: np.ndarray, delta: np.ndarray) -> None:
    assert displacement(delta, delta) == 0.0
    assert spiral(delta, delta) == pytest.approx(0.0, abs=1e-12)
    assert distance(e / abs(e) * abs(delta), delta) == pytest.approx(0.0, abs=1e-12)
    assert bearing(delta * abs(e) / abs(delta), delta) == pytest.approx(0.0, abs=1e-12)


@given(vectors, vectors, st.floats(0.0, 10.0))
def test_on_its_spiral_the_first_follower_is_never_nearer_to_the_leader_than_it_starts_or_ends(
    e: np.ndarray, delta: np.ndarray, t: float
) -> None:
    now = motion("spiral", e, complex(delta)).at(np.array(t))
    assert abs(now) >= min(abs(e), abs(delta)) * (1.0 - 1e-9)
    assert abs(now) <= max(abs(e), abs(delta)) * (1.0 + 1e-9)


@pytest.mark.parametrize("rounding", [-1e-15j, 0j, 1e-15j])
def test_from_opposite_to_its_end_the_spiral_turns_one_way_however_numbers_are_rounded(rounding: complex) -> None:
    u = spiral(np.asarray(-1.0 + rounding), np.asarray(1.0 + 0j))
    assert u == pytest.approx(1j * np.pi, abs=1e-12)


@pytest.mark.parametrize("name", EDGE_LAWS)
@given(vectors, vectors, turns)
def test_every_law_turns_with_a_frame_in_which_both_arguments_turn(
    name: str, e: np.ndarray, delta: np.ndarray, turn: complex
) -> None:
    law = EDGE_LAWS[name]
    assert law(e * turn, delta * turn) == pytest.approx(law(e, delta) * turn, abs=1e-12)


@pytest.mark.parametrize("name", sorted(COMPASS_FREE))
@given(vectors, vectors, turns)
def test_laws_without_compass_do_not_care_how_the_command_is_turned(
    name: str, e: np.ndarray, delta: np.ndarray, turn: complex
) -> None:
    law = EDGE_LAWS[name]
    assert law(e, delta * turn) == pytest.approx(law(e, delta), abs=1e-12)


@given(vectors, vectors)
def test_each_law_is_its_equation_in_real_vectors(e: np.ndarray, delta: np.ndarray) -> None:
    x, d = np.array([e.real, e.imag]), np.array([delta.real, delta.imag])
    b, b_star = x / np.linalg.norm(x), d / np.linalg.norm(d)
    equations = {
        "displacement": -(x - d),
        "distance": -(x @ x - d @ d) * x,
        "bearing": (np.eye(2) - np.outer(b, b)) @ b_star,
    }
    grown, turned = np.log(np.linalg.norm(x) / np.linalg.norm(d)), np.arctan2(d[0] * x[1] - d[1] * x[0], x @ d)
    equations["spiral"] = -grown * x - turned * np.array([-x[1], x[0]])
    for name, expected in equations.items():
        velocity = EDGE_LAWS[name](e, delta)
        np.testing.assert_allclose([velocity.real, velocity.imag], expected, atol=1e-11)
