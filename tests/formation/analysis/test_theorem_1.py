"""Theorem 1, measured: global exponential convergence at rates that the follower angles alone decide."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import (
    AngleLaw,
    AngleSet,
    SensingGraph,
    TargetFormation,
    asymptotic_rates,
    closed_loop_matrix,
    decay_rates,
    end_configuration,
    propagate,
    random_target,
    settling_bound,
)
from formation.analysis.cascade import exponential
from formation.plane import as_complex, as_vectors


def matrix_exponential(matrix: np.ndarray) -> np.ndarray:
    """exp(matrix)."""
    return exponential(lambda states: matrix @ states, len(matrix), float(np.abs(matrix).sum(axis=1).max()))


SEPARATED = 1.1
"""The slowest rate's fit is compared where the next one is faster by this factor."""


def law_matrix(target: TargetFormation) -> np.ndarray:
    """(n, n) the law as a complex matrix, found by asking the law itself for the velocity of each unit position."""
    law, edges = AngleLaw(target), target.graph.edges
    units = np.eye(target.graph.n, dtype=np.complex128)
    relative = units[:, edges[:, 1]] - units[:, edges[:, 0]]
    return as_complex(law(as_vectors(relative))).T


def targets(count: int) -> list[TargetFormation]:
    rng = np.random.default_rng(20230302)
    return [random_target(int(rng.integers(3, 31)), rng) for _ in range(count)]


@pytest.mark.slow
def test_a_thousand_random_formations_converge_at_the_rate_of_their_slowest_follower() -> None:
    rng = np.random.default_rng(1)
    fitted = []
    for target in targets(1000):
        matrix = law_matrix(target)
        rates = decay_rates(target)
        eigenvalues = np.linalg.eigvals(matrix[2:, 2:])
        np.testing.assert_allclose(np.sort(eigenvalues.real), np.sort(-rates), atol=1e-9)
        np.testing.assert_allclose(eigenvalues.imag, 0.0, atol=1e-9)
        start = rng.uniform(-50.0, 50.0, (target.graph.n, 2))
        end = end_configuration(target, *start[:2])
        slow = np.sort(rates)
        horizon = 60.0 / slow[0]
        points = as_vectors(matrix_exponential(matrix * horizon) @ as_complex(start))
        angles = AngleSet.of_followers(target.graph)
        assert np.abs(angles.errors(points, angles.measure(target.positions))).max() < 1e-6
        np.testing.assert_allclose(points, end, atol=1e-9 * np.abs(end).max())
        if len(slow) == 1 or slow[1] > SEPARATED * slow[0]:
            loop = matrix[2:, 2:]
            late = matrix_exponential(loop * horizon) @ as_complex(start - end)[2:]
            later = matrix_exponential(loop * (horizon + 10.0 / slow[0])) @ as_complex(start - end)[2:]
            rate = np.log(np.linalg.norm(late) / np.linalg.norm(later)) * slow[0] / 10.0
            fitted.append(rate / slow[0])
    assert len(fitted) > 300
    np.testing.assert_allclose(fitted, 1.0, atol=0.05)


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 30))
def test_the_closed_loop_matrix_is_what_the_law_does(seed: int, n: int) -> None:
    target = random_target(n, np.random.default_rng(seed))
    matrix = law_matrix(target)
    np.testing.assert_allclose(matrix[1:, 1:], closed_loop_matrix(target), atol=1e-12)
    np.testing.assert_allclose(matrix.sum(axis=1), 0.0, atol=1e-12)  # translations cost nothing


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 12))
def test_eigenvalues_are_minus_sine_squared_of_the_follower_angles(seed: int, n: int) -> None:
    target = random_target(n, np.random.default_rng(seed))
    eigenvalues = np.linalg.eigvals(closed_loop_matrix(target)[1:, 1:])
    np.testing.assert_allclose(np.sort(eigenvalues.real), np.sort(-(np.sin(target.follower_angles) ** 2)), atol=1e-9)


@given(seed=st.integers(0, 2**32 - 1), duration=st.floats(0.01, 20.0))
def test_the_exact_solution_obeys_the_differential_equation(seed: int, duration: float) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    errors = rng.normal(size=(6, 2))
    errors[:2] = 0.0
    h = 1e-5
    ahead, behind = (propagate(target, errors, duration + s) for s in (h, -h))
    slope = as_complex(ahead - behind)[1:] / (2 * h)
    now = as_complex(propagate(target, errors, duration))[1:]
    np.testing.assert_allclose(slope, closed_loop_matrix(target) @ now, atol=1e-8)


@given(seed=st.integers(0, 2**32 - 1))
def test_the_arrival_time_is_the_last_moment_above_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(5, rng, min_angle=np.radians(30.0))
    errors = rng.normal(size=(5, 2))
    errors[:2] = 0.0
    arrival = settling_bound(target, errors, 1e-3)
    assert arrival is not None
    for t in arrival + np.array([0.0, 0.5, 3.0]):
        assert np.linalg.norm(propagate(target, errors, t), axis=1).max() < 1e-3
    just_before = np.linalg.norm(propagate(target, errors, max(arrival - 0.05, 0.0)), axis=1).max()
    assert just_before >= 1e-3


def test_the_late_rate_is_the_slowest_upstream() -> None:
    rng = np.random.default_rng(3)
    target = random_target(20, rng)
    rates, late = decay_rates(target), asymptotic_rates(target)
    assert (late <= rates).all()
    for (i, j), own, slow in zip(target.graph.neighbours, rates, late, strict=True):
        upstream = [late[h - 2] for h in (i, j) if h >= 2]
        assert slow == min([own, *upstream])


@given(
    seed=st.integers(0, 2**32 - 1),
    scale=st.floats(0.01, 100.0),
    angle=st.floats(-np.pi, np.pi),
    shift=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
)
def test_a_similar_target_gives_the_same_law_and_a_similar_start_a_similar_motion(
    seed: int, scale: float, angle: float, shift: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(8, rng)
    move = lambda p: as_vectors(scale * np.exp(1j * angle) * as_complex(p) + complex(*shift))  # noqa: E731
    moved = TargetFormation(target.graph, move(target.positions))
    np.testing.assert_allclose(AngleLaw(moved).gains, AngleLaw(target).gains, atol=1e-7)
    start = rng.normal(size=(8, 2))
    end = end_configuration(target, *start[:2])
    end_of_moved = end_configuration(target, *move(start)[:2])
    np.testing.assert_allclose(end_of_moved, move(end), atol=1e-9 * (1e3 + scale * np.abs(end).max()))


@given(seed=st.integers(0, 2**32 - 1))
def test_rotated_frames_give_the_same_motion_and_reflected_frames_do_not(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(8, rng)
    law, edges = AngleLaw(target), target.graph.edges
    p = rng.normal(size=(8, 2))
    relative = p[edges[:, 1]] - p[edges[:, 0]]
    frame = np.exp(1j * rng.uniform(-np.pi, np.pi, 8))
    local = as_vectors(as_complex(relative) * frame[edges[:, 0]])
    back = as_vectors(as_complex(law(local)) / frame)
    np.testing.assert_allclose(back, law(relative), atol=1e-12 * np.abs(relative).max())
    mirrored = law(relative * [1.0, -1.0]) * [1.0, -1.0]
    assert np.abs(mirrored - law(relative)).max() > 1e-6


def test_ten_thousand_agents_take_one_call() -> None:
    rng = np.random.default_rng(0)
    graph = SensingGraph.random(10_000, rng)
    target = TargetFormation(graph, rng.normal(size=(10_000, 2)))
    p = rng.normal(size=(10_000, 2))
    edges = graph.edges
    velocity = AngleLaw(target)(p[edges[:, 1]] - p[edges[:, 0]])
    k = 9_999
    a_i, a_j, a_k = target.coefficients[k - 2]
    i, j = graph.neighbours[k - 2]
    z = as_complex(p)
    expected = -np.conj(a_k) * (a_i * (z[i] - z[k]) + a_j * (z[j] - z[k]))
    np.testing.assert_allclose(as_complex(velocity)[k], expected, rtol=1e-12)


@pytest.mark.parametrize("rate", [0.5, -0.4999, -3.0, 2j])
def test_the_matrix_exponential_is_exact_to_rounding(rate: complex) -> None:
    jordan = np.array([[rate, 1.0], [0.0, rate]])
    expected = np.exp(rate) * np.array([[1.0, 1.0], [0.0, 1.0]])
    np.testing.assert_allclose(matrix_exponential(jordan), expected, rtol=2e-14, atol=1e-15)


def test_who_is_there_at_the_start_and_stays_has_arrived_at_0() -> None:
    target = random_target(4, np.random.default_rng(3), min_angle=np.radians(30.0))
    errors = np.zeros((4, 2))
    errors[3] = 1e-4, 0.0
    assert settling_bound(target, errors, 1e-3) == 0.0
    errors[3] = 1e-3 * 1.0001, 0.0
    assert settling_bound(target, errors, 1e-3, resolution=0.05) == 0.05
    assert settling_bound(target, errors, 1e-9, horizon=0.1) is None
