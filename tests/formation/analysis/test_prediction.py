"""Theorem 1 before anything moves."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from formation import (
    AngleSet,
    SensingGraph,
    Similarity,
    TargetFormation,
    decay_rates,
    end_configuration,
    end_similarity,
    rotation,
)

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
TARGET = TargetFormation(SensingGraph(np.array([[0, 1], [1, 2]])), SQUARE)
points = st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)).map(np.array)


@given(points, points)
def test_the_end_has_the_shape_and_the_given_leader_and_first_follower(p_1: np.ndarray, p_2: np.ndarray) -> None:
    assume(np.linalg.norm(p_1 - p_2) > 1e-2)
    end = end_configuration(TARGET, p_1, p_2)
    np.testing.assert_allclose(end[:2], [p_1, p_2], atol=1e-12)
    angles = AngleSet.of_followers(TARGET.graph)
    assert np.abs(angles.errors(end, angles.measure(SQUARE))).max() < 1e-9


@given(st.floats(0.1, 10.0), st.floats(0.0, 6.28), points)
def test_the_similarity_is_found_again_from_two_points(scale: float, angle: float, xi: np.ndarray) -> None:
    end = Similarity(scale, angle, tuple(xi))(SQUARE)
    found = end_similarity(TARGET, end[0], end[1])
    assert found.scale == pytest.approx(scale)
    assert np.exp(1j * found.angle) == pytest.approx(np.exp(1j * angle))
    assert found.translation == pytest.approx(tuple(xi), abs=1e-9)


def test_a_similarity_is_c_times_r_theta_p_plus_xi() -> None:
    p = np.array([0.3, -0.7])
    np.testing.assert_allclose(Similarity(2.0, 0.4, (1.0, -1.0))(p), 2.0 * rotation(0.4) @ p + [1.0, -1.0], atol=1e-15)


def test_the_end_does_not_depend_on_which_configuration_states_the_shape() -> None:
    other = TargetFormation(TARGET.graph, Similarity(3.0, 1.0, (5.0, 6.0))(SQUARE))
    a, b = np.array([0.1, 0.2]), np.array([-0.4, 0.9])
    np.testing.assert_allclose(end_configuration(other, a, b), end_configuration(TARGET, a, b), atol=1e-12)
    np.testing.assert_allclose(decay_rates(other), decay_rates(TARGET), atol=1e-12)


def test_coinciding_leader_and_first_follower_are_refused() -> None:
    with pytest.raises(ValueError, match="leader and first follower coincide at"):
        end_similarity(TARGET, np.ones(2), np.ones(2))
