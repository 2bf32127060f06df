"""Barrier certificates: feasible, nearest (by the conditions of optimality), and as the generations define them."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.rps.certificates import OCTAGON, nearest
from robots.rps.version1 import barrier_certificates as first
from robots.rps.version1.barrier_certificates2 import create_robust_barriers
from robots.rps.version2 import barrier_certificates as second

INNER = np.cos(np.pi / 8.0)
seeds = st.integers(0, 10_000)


def scene(seed: int, rows: int = 2, n: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Wishes (2, N) and states (rows, N) of robots on the floor, some of them close to each other."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8)) if n is None else n
    states = np.concatenate([rng.uniform([[-1.4], [-0.9]], [[1.4], [0.9]], (2, n)), rng.uniform(-3.1, 3.1, (1, n))])
    states[:2, 1] = states[:2, 0] + 0.25 * np.array([np.cos(states[2, 0]), np.sin(states[2, 0])])
    return rng.uniform(-0.3, 0.3, (2, n)), states[:rows]


def pairs(states: np.ndarray, u: np.ndarray, gain: float, distance: float) -> np.ndarray:
    """2 e.(u_i - u_j) + gain h^3 of all pairs: not negative where they are safe."""
    i, j = np.triu_indices(u.shape[1], 1)
    e = states[:2, i] - states[:2, j]
    h = (e**2).sum(axis=0) - distance**2
    return 2.0 * (e * (u[:, i] - u[:, j])).sum(axis=0) + gain * h**3


def walls(states: np.ndarray, u: np.ndarray, gain: float, distance: float, boundary: tuple[float, ...]) -> np.ndarray:
    low_x, high_x, low_y, high_y = boundary
    x, y = states[:2]
    gap = np.array([x - low_x, high_x - x, y - low_y, high_y - y]) - distance / 2.0
    return np.array([u[0], -u[0], u[1], -u[1]]) + 0.4 * gain * gap**3


@given(seeds)
def test_the_program_is_solved_to_its_optimality_conditions(seed: int) -> None:
    """Feasible, and no way to any other feasible point leads nearer to the wish."""
    rng = np.random.default_rng(seed)
    k, m = int(rng.integers(1, 8)), int(rng.integers(1, 20))
    rows, wish = rng.normal(size=(m, k)), rng.normal(size=k)
    bounds = rng.uniform(0.1, 1.0, m)
    root = rng.normal(size=(k, k))
    weight = np.eye(k) + root @ root.T
    x = nearest(wish, rows, bounds, np.ones(m, dtype=bool), weight)
    assert (rows @ x <= bounds + 1e-6).all()
    others = rng.normal(size=(200, k))  # 0 satisfies all rows, and so does a part of the way to anywhere
    others *= 1.0 / np.maximum((others @ rows.T / bounds).max(axis=1, keepdims=True), 1.0)
    assert ((others - x) @ weight @ (x - wish) >= -1e-6 * (1.0 + np.abs(weight).max())).all()


def test_a_program_without_solution_is_relaxed_where_it_may_be() -> None:
    rows, bounds = np.array([[1.0], [-1.0], [1.0]]), np.array([-1.0, -3.0, 2.5])
    x = nearest(np.zeros(1), rows, bounds, np.array([False, False, True]))
    np.testing.assert_allclose(x, 1.0, atol=1e-6)  # halfway between x <= -1 and x >= 3, by 2 each


@given(seeds)
def test_single_integrator_certificates_of_2_1_satisfy_their_rows(seed: int) -> None:
    wish, x = scene(seed, rows=3)
    for boundary in (None, (-1.7, 1.7, -1.1, 1.1)):
        make = second.create_si_barrier_certificate if boundary is None else (
            second.create_si_barrier_certificate_with_boundary
        )  # fmt: skip
        u = make()(wish, x)
        assert (pairs(x, u, 100.0, 0.15) >= -1e-6).all()
        sides = np.full(8, 0.2 * INNER)
        if boundary is None:
            sides[0] = 0.2
        else:
            assert (walls(x, u, 100.0, 0.15, boundary) >= -1e-6).all()
        assert (OCTAGON @ u <= sides[:, None] + 1e-6).all()


@given(seeds)
def test_single_integrator_certificates_of_1_cut_the_wish_and_satisfy_their_rows(seed: int) -> None:
    wish, x = scene(seed)
    before = wish.copy()
    u = first.create_single_integrator_barrier_certificate()(wish, x)
    assert (pairs(x, u, 100.0, 0.17) >= -1e-6).all()
    u = first.create_single_integrator_barrier_certificate_with_boundary()(wish, x)
    assert (walls(x, u, 100.0, 0.17, (-1.6, 1.6, -1.0, 1.0)) >= -1e-6).all()
    np.testing.assert_array_equal(wish, before)


def test_a_free_robot_does_as_it_wishes_up_to_its_limit() -> None:
    x = np.array([[-1.0, 1.0], [0.0, 0.0]])
    wish = np.array([[0.1, 0.0], [0.0, 0.4]])
    np.testing.assert_allclose(first.create_single_integrator_barrier_certificate()(wish, x), [[0.1, 0.0], [0.0, 0.2]])
    safe = second.create_si_barrier_certificate()(wish, x)
    np.testing.assert_allclose(safe, [[0.1, 0.0], [0.0, 0.2 * INNER]], atol=1e-9)


def test_one_robot_alone_gets_its_wish_back() -> None:
    wish, x = np.array([[1.0], [2.0]]), np.zeros((3, 1))
    for make in (
        second.create_si_barrier_certificate,
        second.create_si_barrier_certificate_with_boundary,
        second.create_uni_barrier_certificate,
        second.create_uni_barrier_certificate_with_boundary,
    ):
        assert make()(wish, x) is wish


def test_robots_that_are_too_close_part_with_the_gain_that_is_theirs() -> None:
    x = np.array([[0.0, 0.12], [0.0, 0.0]])
    rest = np.zeros((2, 2))
    gently = first.create_single_integrator_barrier_certificate()(rest, x)
    firmly = first.create_single_integrator_barrier_certificate2()(rest, x)
    assert np.linalg.norm(gently) < 0.02 < np.linalg.norm(firmly)
    h = 0.12**2 - 0.17**2
    np.testing.assert_allclose(firmly[0, 0] - firmly[0, 1], 1e6 * h**3 / (2.0 * 0.12), rtol=1e-6)


@given(seeds)
def test_unicycle_certificates_are_those_of_the_points_ahead(seed: int) -> None:
    wish, x = scene(seed, rows=3)
    heading = np.array([np.cos(x[2]), np.sin(x[2])])

    def point(u: np.ndarray, distance: float) -> np.ndarray:
        return u[0] * heading + distance * u[1] * np.array([-heading[1], heading[0]])

    safe = second.create_uni_barrier_certificate()(wish, x)
    assert (pairs(x[:2] + 0.05 * heading, point(safe, 0.05), 100.0, 0.25) >= -1e-6).all()
    inside = x * [[0.8], [0.8], [1.0]]
    safe = second.create_uni_barrier_certificate_with_boundary()(wish, inside)
    points = inside[:2] + 0.03 * heading
    assert (pairs(points, point(safe, 0.03), 150.0, 0.18) >= -1e-6).all()
    assert (walls(points, point(safe, 0.03), 150.0, 0.18, (-1.6, 1.6, -1.0, 1.0)) >= -1e-6).all()
    for make in (
        first.create_unicycle_barrier_certificate,
        first.create_unicycle_barrier_certificate_with_boundary,
        first.create_unicycle_barrier_certificate2,
    ):
        assert (np.abs(make()(wish, x)[1]) <= np.pi + 1e-9).all()


def test_obstacles_of_the_unicycle_certificate_stand_and_are_avoided() -> None:
    x = np.array([[0.0, 1.0], [0.0, 0.5], [0.0, 0.0]])
    certificate = second.create_uni_barrier_certificate_with_boundary()
    obstacles = np.array([[0.3, 0.35], [0.0, 0.02]])
    for _ in range(600):
        v, omega = certificate(np.array([[0.15, 0.0], [0.0, 0.0]]), x, obstacles)
        x = x + 0.033 * np.array([v * np.cos(x[2]), v * np.sin(x[2]), omega])
        point = x[:2, :1] + 0.03 * np.array([np.cos(x[2, :1]), np.sin(x[2, :1])])
        assert np.linalg.norm(point - obstacles, axis=0).min() >= 0.18 - 1e-3
    free = certificate(np.array([[0.15, 0.0], [0.0, 0.0]]), x, np.empty((2, 0)))
    np.testing.assert_allclose(free, certificate(np.array([[0.15, 0.0], [0.0, 0.0]]), x))


@given(seeds)
def test_robust_certificates_hold_whatever_the_disturbance(seed: int) -> None:
    wish, x = scene(seed, rows=3, n=3)
    x[:2, 2] = x[:2, 0] - 0.6
    heading = np.array([np.cos(x[2]), np.sin(x[2])])
    points = x[:2] + 0.05 * heading
    certificate = first.create_unicycle_differential_drive_barrier_certificate(disturbance=0.5)
    safe = certificate(wish, x)
    wheels = np.array([safe[0] - 0.0525 * safe[1], safe[0] + 0.0525 * safe[1]]) / 0.016
    assert (np.abs(wheels) <= 12.5 + 1e-6).all()
    rng = np.random.default_rng(seed)
    for _ in range(5):
        left, right = wheels + rng.choice([-0.5, 0.5], (2, 3))
        v, omega = 0.008 * (left + right), 0.016 / 0.105 * (right - left)
        moved = v * heading + 0.05 * omega * np.array([-heading[1], heading[0]])
        assert (pairs(points, moved, 150.0, 0.17) >= -1e-6).all()


def test_the_robust_certificate_keeps_off_obstacles_and_walls() -> None:
    x, wish = np.array([[0.0, 1.4], [0.0, 0.0], [0.0, 0.0]]), np.array([[0.2, 0.2], [0.0, 0.0]])
    within = first.create_unicycle_differential_drive_barrier_certificate_with_boundary()
    assert within(wish, x)[0, 1] < 0.1 < within(wish, x)[0, 0]
    robust = create_robust_barriers()
    assert robust(wish, x, np.empty(0))[0, 0] > 0.15
    assert robust(wish, x, np.array([[0.2], [0.0]]))[0, 0] < 0.05


def test_the_solver_that_an_example_calls_says_where_there_is_nothing() -> None:
    box = np.concatenate([np.eye(2), -np.eye(2)])
    np.testing.assert_allclose(second._solve_qp(1, np.array([3.0, 0.2]), box, np.ones(4)), [[1.0], [0.2]], atol=1e-9)
    assert second._solve_qp(1, np.zeros(2), box, np.array([-1.0, 1.0, -1.0, 1.0])) is None


@pytest.mark.parametrize("n", [2, 20])
def test_many_robots_sent_to_one_place_stay_apart(n: int) -> None:
    rng = np.random.default_rng(3)
    x = np.stack(np.meshgrid(np.linspace(-1.2, 1.2, 5), np.linspace(-0.7, 0.7, 4))).reshape(2, -1)[:, :n]
    x = x + rng.uniform(-0.05, 0.05, x.shape)
    certificate: Callable[[np.ndarray, np.ndarray], np.ndarray] = second.create_si_barrier_certificate_with_boundary()
    for _ in range(60):
        x = x + 0.033 * certificate(-x, x)
        assert np.linalg.norm(x[:, :, None] - x[:, None] + 9.0 * np.eye(n), axis=0).min() >= 0.15
