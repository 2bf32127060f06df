"""Theorem 2 and the first-follower laws: what a maneuver steers and what it leaves alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from formation import (
    EDGE_LAWS,
    AngleLaw,
    AngleSet,
    Phase,
    end_configuration,
    fit_similarity,
    pair_ends,
    propagate,
    random_target,
    wrap,
)
from formation.plane import as_complex, as_vectors

angle = st.floats(-3.0, 3.0)
length = st.floats(0.2, 2.0)


def settle(law: str, e: complex, delta: complex, duration: float = 200.0) -> complex:
    """e_12 after ``duration`` seconds of de/dt = u_2, by a Runge-Kutta pair of the eighth order."""
    speed = lambda _, x: EDGE_LAWS[law](x, np.array([delta]))  # noqa: E731
    return complex(solve_ivp(speed, (0.0, duration), [e], "DOP853", rtol=1e-9, atol=1e-11).y[0, -1])


@pytest.mark.parametrize("law", ["stationary", "displacement", "distance", "bearing", "spiral"])
@given(r=length, a=angle, r_star=length, turn=st.floats(-2.5, 2.5))
def test_the_predicted_pair_is_where_the_first_followers_law_settles(
    law: str, r: float, a: float, r_star: float, turn: float
) -> None:
    e, delta = r * np.exp(1j * a), r_star * np.exp(1j * (a + turn))
    phase = Phase("p", 100.0, (0.1, -0.2), (delta.real, delta.imag))
    leader = np.array([3.0, 4.0])
    start = np.stack([leader, leader + [e.real, e.imag]])
    end = pair_ends(start, [phase], law)[0]
    np.testing.assert_allclose(end[0], leader + [10.0, -20.0], atol=1e-12)
    predicted = as_complex(end[1] - end[0])
    np.testing.assert_allclose(settle(law, e, delta), predicted, atol=1e-6)


@given(r=length, a=angle, r_star=length, turn=st.floats(-2.5, 2.5))
def test_distance_steers_scale_and_leaves_orientation(r: float, a: float, r_star: float, turn: float) -> None:
    end = settle("distance", r * np.exp(1j * a), r_star * np.exp(1j * (a + turn)))
    assert abs(end) == pytest.approx(r_star, abs=1e-6)
    assert wrap(np.angle(end) - a) == pytest.approx(0.0, abs=1e-9)


@given(r=length, a=angle, r_star=length, turn=st.floats(-2.5, 2.5))
def test_bearing_steers_orientation_and_leaves_scale(r: float, a: float, r_star: float, turn: float) -> None:
    end = settle("bearing", r * np.exp(1j * a), r_star * np.exp(1j * (a + turn)))
    assert abs(end) == pytest.approx(r, abs=1e-6)
    assert wrap(np.angle(end) - a - turn) == pytest.approx(0.0, abs=1e-6)


@given(seed=st.integers(0, 2**32 - 1))
def test_displacement_decays_at_rate_one_and_shape_and_velocity_follow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(7, rng, min_angle=np.radians(30.0))
    errors = rng.normal(size=(7, 2))
    errors[0] = 0.0
    later = propagate(target, errors, 3.0, "displacement")
    np.testing.assert_allclose(later[1], np.exp(-3.0) * errors[1], atol=1e-12)  # eq. (mane1)
    delta = np.array([0.4, 0.4])
    end = end_configuration(target, np.zeros(2), delta)
    points = end + propagate(target, errors, 300.0, "displacement")
    angles = AngleSet.of_followers(target.graph)
    assert np.abs(angles.errors(points, angles.measure(target.positions))).max() < 1e-9  # eq. (shape)
    edges = target.graph.edges
    law = AngleLaw(target, "displacement")
    velocity = law((points[edges[:, 1]] - points[edges[:, 0]]), np.tile([1.0, 0.0], (7, 1)), delta)
    np.testing.assert_allclose(velocity, 0.0, atol=1e-9)  # eq. (mane2), of agent 2 as well: only v_r is left


@given(seed=st.integers(0, 2**32 - 1), scale=st.floats(0.1, 10.0), turn=st.floats(0.0, 6.2))
def test_a_similarity_is_recovered_from_the_points_it_moves(seed: int, scale: float, turn: float) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(9, rng)
    points = as_vectors(scale * np.exp(1j * turn) * as_complex(target.positions) + 2 - 3j)
    c, theta, centroid = fit_similarity(target, points)
    assert c == pytest.approx(scale, rel=1e-12)
    assert wrap(theta - turn) == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(centroid, points.mean(axis=0), atol=1e-12)


@given(seed=st.integers(0, 2**32 - 1), turn=angle)
def test_only_compass_free_laws_ignore_the_frame(seed: int, turn: float) -> None:
    rng = np.random.default_rng(seed)
    e, delta = (complex(*rng.normal(size=2)) for _ in range(2))
    frame = np.exp(1j * turn)
    for name, law in EDGE_LAWS.items():
        rotated = law(np.array(e * frame), np.array(delta)) / frame
        same = bool(np.abs(rotated - law(np.array(e), np.array(delta))) < 1e-9 * (1 + abs(e) ** 3))
        if name in ("stationary", "distance"):
            assert same
        elif abs(wrap(turn)) > 0.1:
            assert not same


def test_a_law_without_its_compass_or_displacement_says_so() -> None:
    target = random_target(3, np.random.default_rng(0))
    law = AngleLaw(target, "displacement")
    with pytest.raises(ValueError, match="delta is missing"):
        law(np.zeros((3, 2)))
    with pytest.raises(ValueError, match="compass is missing"):
        law(np.zeros((3, 2)), None, np.ones(2))
    with pytest.raises(ValueError, match="first_follower must be one of"):
        AngleLaw(target, "sideways")
