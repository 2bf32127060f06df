"""Controllers to positions and poses: their equations, and that robots arrive."""

from collections.abc import Callable

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robots.rps.version1 import controllers as first
from robots.rps.version2 import controllers as second

positions = arrays(np.float64, (2, 3), elements=st.floats(-1.5, 1.5))
poses = arrays(np.float64, (3, 3), elements=st.floats(-1.5, 1.5))


Controller = Callable[[np.ndarray, np.ndarray], np.ndarray]


def drive(controller: Controller, x: np.ndarray, goals: np.ndarray, steps: int) -> np.ndarray:
    """Poses (steps, 3, N) of unicycles on their arcs, every 0.033 s."""
    x, seen = x.copy(), []
    for _ in range(steps):
        v, omega = controller(x, goals)
        middle = x[2] + 0.0165 * omega
        x += 0.033 * np.array([v * np.cos(middle), v * np.sin(middle), omega])
        seen.append(x.copy())
    return np.array(seen)


@given(positions, positions, st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(0.0, 0.5))
def test_the_position_controller_is_proportional_up_to_its_limit(
    x: np.ndarray, goals: np.ndarray, gx: float, gy: float, limit: float
) -> None:
    u = second.create_si_position_controller(gx, gy, limit)(x, goals)
    wish = np.array([[gx], [gy]]) * (goals - x)
    length = np.linalg.norm(wish, axis=0)
    assert (np.linalg.norm(u, axis=0) <= limit + 1e-12).all()
    np.testing.assert_allclose(u[0] * wish[1], u[1] * wish[0], atol=1e-12)
    short = length <= limit
    np.testing.assert_allclose(u[:, short], wish[:, short], atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(u[:, ~short], axis=0), limit, atol=1e-12)


def test_generations_differ_in_their_gains() -> None:
    x, goals = np.zeros((2, 1)), np.full((2, 1), 0.1)
    np.testing.assert_allclose(second.create_si_position_controller()(x, goals), 0.08)
    np.testing.assert_allclose(first.create_si_position_controller()(x, goals), 0.1)


def test_unicycles_arrive_with_their_points() -> None:
    rng = np.random.default_rng(0)
    x, goals = rng.uniform(-1.0, 1.0, (3, 6)), rng.uniform(-1.0, 1.0, (2, 6))
    end = drive(second.create_uni_position_controller(), x, goals, 900)[-1]
    points = end[:2] + 0.03 * np.array([np.cos(end[2]), np.sin(end[2])])
    np.testing.assert_allclose(points, goals, atol=1e-3)


def test_pose_controllers_bring_robots_to_their_poses() -> None:
    rng = np.random.default_rng(1)
    x, goals = rng.uniform(-1.0, 1.0, (3, 8)), rng.uniform(-1.0, 1.0, (3, 8))
    for make in (
        second.create_pose_controller_clf,
        second.create_pose_controller_hybrid,
        second.create_pose_parking_controller_clf,
        second.create_pose_parking_controller_hybrid,
        first.create_clf_unicycle_pose_controller,
        first.create_hybrid_unicycle_pose_controller,
    ):
        controller, poses, arrived = make(), x, np.zeros(8, dtype=bool)
        for _ in range(10):
            poses = (seen := drive(controller, poses, goals, 150))[-1]
            near = np.hypot(*(seen - goals)[:, :2].transpose(1, 0, 2)) < 0.05
            straight = np.abs(np.angle(np.exp(1j * (seen - goals)[:, 2]))) < 0.2
            arrived |= (near & straight).any(axis=0)
            if arrived.all():
                break
        assert arrived.all(), make.__name__


def test_parked_robots_stand() -> None:
    x, goals = np.array([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]]), np.array([[0.04, 0.0], [0.0, 0.0], [0.1, 0.0]])
    for make in (second.create_pose_parking_controller_clf, second.create_pose_parking_controller_hybrid):
        command = make()(x, goals)
        assert (command[:, 0] == 0.0).all()
        assert (command[:, 1] != 0.0).any()


@given(poses, poses)
def test_the_lyapunov_controller_decreases_its_function(x: np.ndarray, goals: np.ndarray) -> None:
    """V = e^2/2 + (alpha^2 + h theta^2)/2, whose derivative is -g e^2 cos^2 alpha - k alpha^2 (Aicardi et al. 1995)."""

    def function(x: np.ndarray) -> np.ndarray:
        way = goals[:2] - x[:2]
        distance = np.hypot(*way)
        theta = np.angle(np.exp(1j * (np.arctan2(way[1], way[0]) - goals[2])))
        alpha = np.angle(np.exp(1j * (theta - x[2] + goals[2])))
        return (distance**2 + alpha**2 + theta**2) / 2.0

    v, omega = first.create_clf_unicycle_pose_controller()(x, goals)
    step = 1e-7
    moved = x + step * np.array([v * np.cos(x[2]), v * np.sin(x[2]), omega])
    way = goals[:2] - x[:2]
    theta = np.angle(np.exp(1j * (np.arctan2(way[1], way[0]) - goals[2])))
    alpha = np.angle(np.exp(1j * (theta - x[2] + goals[2])))
    smooth = (np.hypot(*way) > 0.01) & (np.abs(theta) < 3.1) & (np.abs(alpha) < 3.1)
    rate = -(np.hypot(*way) ** 2) * np.cos(alpha) ** 2 - 2.7 * alpha**2
    measured = (function(moved) - function(x)) / step
    np.testing.assert_allclose(measured[smooth], rate[smooth], rtol=1e-3, atol=2e-3)


@given(poses, poses, st.floats(1.0, 12.0))
def test_wheels_are_slowed_together(x: np.ndarray, goals: np.ndarray, limit: float) -> None:
    free = first.create_clf_unicycle_pose_controller()(x, goals)
    slowed = second.create_pose_controller_clf(wheel_velocity_limit=limit)(x, goals)
    np.testing.assert_allclose(free[0] * slowed[1], free[1] * slowed[0], atol=1e-9)
    wheels = np.array([slowed[0] - 0.0525 * slowed[1], slowed[0] + 0.0525 * slowed[1]]) / 0.016
    assert (np.abs(wheels) <= limit * (1.0 + 1e-9)).all()


def test_the_hybrid_controller_drives_again_when_its_turn_has_carried_it_off() -> None:
    controller = second.create_pose_controller_hybrid()
    goal = np.zeros((3, 1))
    at, off = np.array([[0.015], [0.0], [1.0]]), np.array([[0.04], [0.0], [1.0]])
    assert controller(at, goal)[0, 0] == 0.0, "it turns"
    assert controller(off, goal)[0, 0] == 0.0, "it notices only"
    assert controller(off, goal)[0, 0] != 0.0, "it drives"
    command, driving = controller(off, goal, np.zeros(1))
    assert (command[0, 0], driving[0]) == (0.0, 1.0)
    assert first.create_hybrid_unicycle_pose_controller()(off, goal)[0, 0] != 0.0, "version 1 has no memory"


@given(poses, positions)
def test_the_position_clf_steers_by_the_bearing(x: np.ndarray, goals: np.ndarray) -> None:
    v, omega = first.create_clf_unicycle_position_controller(0.8, 3.0)(x, goals)
    way = (goals - x[:2])[0] + 1j * (goals - x[:2])[1]
    seen = way * np.exp(-1j * x[2])
    np.testing.assert_allclose(v, 0.8 * seen.real, atol=1e-12)
    np.testing.assert_allclose(omega, 3.0 * seen.imag, atol=1e-12)
