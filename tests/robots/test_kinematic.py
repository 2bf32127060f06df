"""The worlds without mass: exact arcs, order four, batches."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, NearIdentityDiffeomorphism, make_world
from robots.worlds.kinematic import SingleIntegrator, Unicycle, arc_chord

NID = NearIdentityDiffeomorphism(0.025)
KINEMATIC = ["single_integrator", "unicycle", "saturated"]


@given(st.floats(-0.2, 0.2), st.floats(-3.6, 3.6), st.floats(-np.pi, np.pi), st.floats(0.01, 1.0))
def test_the_arc_in_closed_form_is_the_limit_of_fine_integration(
    v: float, omega: float, theta: float, period: float
) -> None:
    unicycle = Unicycle(np.array([[0.1, -0.2, theta]]), NID, GTERNAL.drive)
    unicycle.step(lambda points, headings, _: np.array([[v, omega * NID.projection_distance]]), period)
    fine = 4000
    h = period / fine
    middle = theta + omega * h * (np.arange(fine) + 0.5)
    expected = [0.1 + v * h * np.cos(middle).sum(), -0.2 + v * h * np.sin(middle).sum(), theta + omega * period]
    np.testing.assert_allclose(unicycle.poses[0], expected, atol=1e-7)


@given(st.floats(-0.1, 0.1))
def test_the_chord_of_a_small_turn_keeps_full_accuracy(turn: float) -> None:
    """Against the series of (e^{ix} - 1) / (ix), whose next term is below 1e-16."""
    x = 1j * turn
    series = 1 + x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7 * (1 + x / 8 * (1 + x / 9)))))))
    assert arc_chord(np.ones(1), np.zeros(1), np.array([turn]))[0] == pytest.approx(series, abs=1e-15)


def test_the_chord_of_no_turn_is_the_path() -> None:
    assert arc_chord(np.ones(2), np.zeros(2), np.array([0.0, 5e-324])) == pytest.approx([1.0, 1.0], abs=1e-15)


def end_of_linear_flow(period: float) -> complex:
    """p(1) of dp/dt = (-1 + 2i) p, p(0) = 1."""
    world = SingleIntegrator(np.array([[1.0, 0.0]]), np.array([0.0]))
    for _ in range(round(1.0 / period)):
        world.step(lambda p, headings, _: ((-1 + 2j) * p.view(np.complex128)).view(np.float64), period)
    return complex(*world.points[0])


def test_the_single_integrator_converges_with_order_four() -> None:
    errors = [abs(end_of_linear_flow(h) - np.exp(-1 + 2j)) for h in (0.1, 0.05, 0.025)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([4.0, 4.0], abs=0.1)


def test_a_command_in_a_points_own_frame_moves_it_along_that_frame() -> None:
    world = SingleIntegrator(np.zeros((2, 2)), np.array([0.0, np.pi / 2.0]))
    world.step(lambda points, headings, _: np.array([[1.0, 0.0], [1.0, 0.0]]), 0.5)
    np.testing.assert_allclose(world.points, [[0.5, 0.0], [0.0, 0.5]], atol=1e-15)


@pytest.mark.parametrize("plant", KINEMATIC)
def test_a_batch_equals_its_single_runs(plant: str) -> None:
    rng = np.random.default_rng(0)
    points, theta = rng.normal(size=(3, 2, 5, 2)), rng.uniform(-3.0, 3.0, (3, 2, 5))

    def attract(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
        return -points + 0.3 * headings

    def run(points: np.ndarray, theta: np.ndarray) -> np.ndarray:
        world = make_world(plant, points, theta, nid=NID, robot=GTERNAL)
        for _ in range(50):
            world.step(attract, 0.033)
        return world.poses

    batch = run(points, theta)
    for index in np.ndindex(3, 2):
        np.testing.assert_allclose(batch[index], run(points[index], theta[index]), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("limit", "agrees"), [(1e6, True), (1.0, False)])
def test_the_saturated_unicycle_is_the_unicycle_until_a_wheel_meets_its_limit(limit: float, agrees: bool) -> None:
    import dataclasses

    robot = dataclasses.replace(GTERNAL, drive=dataclasses.replace(GTERNAL.drive, wheel_speed_limit=limit))
    start = np.array([[1.0, 0.5]]), np.array([1.0])

    def end(plant: str) -> np.ndarray:
        world = make_world(plant, *start, nid=NID, robot=robot)
        for _ in range(20):
            world.step(lambda points, headings, _: -points, 0.033)
        return world.poses

    assert np.allclose(end("unicycle"), end("saturated"), atol=1e-12) == agrees


def test_headings_count_whole_turns() -> None:
    world = Unicycle(np.zeros((1, 3)), NID, GTERNAL.drive)
    spin: Callable[[np.ndarray, np.ndarray], np.ndarray] = lambda points, headings, _: np.array([[0.0, 0.025]])  # noqa: E731
    for _ in range(20):
        world.step(spin, 1.0)
    assert world.poses[0, 2] == pytest.approx(20.0)


@pytest.mark.parametrize("steps", [1, 3])
def test_a_point_that_is_steered_by_time_alone_goes_its_integral(steps: int) -> None:
    """Of a cubic of time a fourth-order step is exact; time runs on through the steps of a period."""
    world = SingleIntegrator(np.array([[0.5, -0.5]]), np.array([0.7]), steps)
    turn = np.exp(-0.7j)

    def velocity(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
        told = complex(4.0 * elapsed**3, 3.0 * elapsed**2) * turn
        return np.array([[told.real, told.imag]])

    world.step(velocity, 1.5)
    np.testing.assert_allclose(world.points, [[0.5 + 1.5**4, -0.5 + 1.5**3]])


@pytest.mark.parametrize("plant", KINEMATIC)
def test_a_push_moves_a_robot_and_turns_it_not(plant: str) -> None:
    points, theta = np.array([[0.1, 0.2], [-0.3, 0.4]]), np.array([0.3, -2.0])
    world = make_world(plant, points, theta, nid=NID, robot=GTERNAL)
    push = np.array([[0.05, -0.02], [0.0, 0.01]])
    before = world.poses.copy()
    world.push(push)
    np.testing.assert_allclose(world.points, points + push)
    np.testing.assert_allclose(world.poses[:, :2], before[:, :2] + push)
    np.testing.assert_array_equal(world.poses[:, 2], before[:, 2])
    np.testing.assert_allclose(world.headings, np.stack([np.cos(theta), np.sin(theta)], axis=1))
