"""What all four worlds promise."""

import numpy as np
import pytest

from robots import GTERNAL, PLANTS, NearIdentityDiffeomorphism, World, make_world

NID = NearIdentityDiffeomorphism(0.025)
POINTS = np.array([[0.0, 0.0], [0.5, 0.1], [-0.4, 0.3]])
THETA = np.array([0.3, -2.0, 7.0])


def world(plant: str, points: np.ndarray = POINTS, theta: np.ndarray = THETA) -> World:
    return make_world(plant, points, theta, nid=NID, robot=GTERNAL)


def stand(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
    return np.zeros_like(points)


def forward(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
    return np.zeros_like(points) + [0.1, 0.0]


@pytest.mark.parametrize("plant", PLANTS)
def test_a_world_starts_at_the_given_projected_points_and_headings(plant: str) -> None:
    w = world(plant)
    np.testing.assert_allclose(w.points, POINTS, atol=1e-15)
    np.testing.assert_allclose(w.headings, np.stack([np.cos(THETA), np.sin(THETA)], axis=-1), atol=1e-15)
    np.testing.assert_allclose(w.poses[:, 2], THETA)


@pytest.mark.parametrize("plant", PLANTS)
def test_a_robot_that_is_told_to_stand_stands(plant: str) -> None:
    w = world(plant)
    for _ in range(30):
        w.step(stand, 0.033)
    np.testing.assert_allclose(w.points, POINTS, atol=1e-13)


@pytest.mark.parametrize("plant", PLANTS)
def test_forward_is_along_the_robots_own_heading(plant: str) -> None:
    w = world(plant)
    for _ in range(30):
        w.step(forward, 0.033)
    moved = w.points - POINTS
    np.testing.assert_allclose(moved, 0.1 * 0.99 * w.headings, atol=2e-3)
    sideways = moved[:, 0] * w.headings[:, 1] - moved[:, 1] * w.headings[:, 0]
    assert np.abs(sideways).max() < 1e-12


@pytest.mark.parametrize("plant", PLANTS)
def test_points_headings_and_poses_tell_the_same_state(plant: str) -> None:
    w = world(plant)
    for k in range(20):
        w.step(lambda points, headings, _, k=k: 0.1 * np.sin(points * 9.0 + k), 0.033)
    theta = w.poses[:, 2]
    np.testing.assert_allclose(w.headings, np.stack([np.cos(theta), np.sin(theta)], axis=-1), atol=1e-15)
    expected = w.poses[:, :2] if plant == "single_integrator" else NID.project(w.poses)
    np.testing.assert_allclose(w.points, expected, atol=1e-15)


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_no_wheel_turns_faster_than_its_limit(plant: str) -> None:
    w = world(plant)
    for _ in range(10):
        w.step(lambda points, headings, _: np.full_like(points, 3.0), 0.033)
        assert np.abs(w.wheel_speeds).max() == pytest.approx(GTERNAL.drive.wheel_speed_limit)


@pytest.mark.parametrize("plant", PLANTS)
def test_a_world_keeps_its_own_copy_of_its_start(plant: str) -> None:
    points, theta = POINTS.copy(), THETA.copy()
    world(plant, points, theta).step(forward, 0.033)
    assert (points == POINTS).all()
    assert (theta == THETA).all()


@pytest.mark.parametrize("plant", PLANTS)
def test_the_rows_of_a_step_do_not_change_with_the_next(plant: str) -> None:
    """A recorder may keep the points and headings that a world shows."""
    w = world(plant)
    w.step(forward, 0.033)
    points, before = w.points, w.points.copy()
    w.step(forward, 0.033)
    assert (points == before).all()


def test_points_have_no_wheels() -> None:
    w = world("single_integrator")
    w.step(forward, 0.033)
    assert np.isnan(w.wheel_speeds).all()


def test_an_unknown_plant_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"plant must be one of single_integrator, .*, got 'pymnk'"):
        world("pymnk")
