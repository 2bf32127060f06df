"""What measured robots make of a draw: slip, late cameras, lost commands, each by its own formula."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots import GTERNAL, NearIdentityDiffeomorphism, make_world
from robots.measured import MEASURED
from robots.measured.camera import KEPT, Camera
from robots.obstacles import Obstacle, disc, pack

SEEDS = st.integers(0, 2**32 - 1)
NUMBERS = MEASURED.numbers
TURN = 1.0 / 15.0


def measured() -> Any:
    points = np.array([[0.0, 0.0], [0.4, 0.1], [-0.3, 0.5]])
    return make_world(
        "saturated", points, np.array([0.3, -2.0, 1.0]), nid=NearIdentityDiffeomorphism(0.025), robot=GTERNAL,
        measured=MEASURED, generators=[np.random.default_rng(1)],
    )  # fmt: skip


def test_wheels_move_each_robot_by_its_own_numbers_and_its_own_slip() -> None:
    world, period = measured(), 0.05
    wheels, normal = np.array([[3.0, 4.0], [-2.0, 2.0], [0.0, 0.0]]), np.array([[0.5, -1.0], [2.0, 0.3], [1.0, 1.0]])
    found = world._twist(wheels, normal, period)
    for robot in range(3):
        left, right = world.radius[robot] * wheels[robot]
        v, omega = (left + right) / 2.0, (right - left) / world.base[robot]
        way, turn = abs(v) * period, abs(omega) * period
        along = NUMBERS.slip_along * np.sqrt(way) * normal[robot, 0] / period
        heading = np.sqrt(NUMBERS.slip_heading**2 * way + NUMBERS.slip_turning**2 * turn) * normal[robot, 1] / period
        np.testing.assert_allclose(found[robot], [v + along, omega + heading])
    assert len(set(world.radius.tolist())) == len(set(world.base.tolist())) == 3


@settings(max_examples=20)
@given(seed=SEEDS)
def test_cameras_see_the_tracked_point_of_a_while_ago_with_noise_of_their_own(seed: int) -> None:
    rng, period, n = np.random.default_rng(seed), 0.033, 3
    model = replace(MEASURED, numbers=replace(NUMBERS, position_noise=0.01, heading_noise=0.1, stale=0.3, jitter=0.5))
    poses = np.cumsum(rng.normal(0.0, 0.05, (9, n, 3)), axis=0)
    camera = Camera(poses[0], model)
    memory = NUMBERS.jitter_memory ** (period / TURN)
    jitter, seen, kept = np.zeros(n), camera.seen.copy(), [poses[0]] * 50
    for pose in poses[1:]:
        normal, luck = rng.normal(size=(n, 4)), rng.random(n)
        camera.take(pose, normal, luck, period)
        kept = [pose, *kept]
        jitter = memory * jitter + np.sqrt(1.0 - memory**2) * 0.5 * TURN * normal[:, 3]
        for robot in range(n):
            age = max(0.0, (0.033 + jitter[robot]) / period)
            past = [each[robot] for each in kept]
            x, y, theta = (np.interp(age, np.arange(len(past)), np.array(past)[:, axis]) for axis in range(3))
            tracked = complex(x, y) + complex(NUMBERS.offset_ahead, NUMBERS.offset_left) * np.exp(1j * theta)
            if luck[robot] >= 0.3:
                seen[robot, :2] = np.array([tracked.real, tracked.imag]) + 0.01 * normal[robot, :2]
                seen[robot, 2] = theta + NUMBERS.marker_angle + 0.1 * normal[robot, 2]
            assert camera.seen[robot, :2] == pytest.approx(seen[robot, :2])
            assert abs(camera.seen[robot, 2] - seen[robot, 2]) <= 0.5e-3 + 1e-9  # rounded to a milliradian


def test_however_late_a_camera_is_it_shows_no_more_than_it_has_kept() -> None:
    poses = np.arange(12.0)[:, None, None] * np.array([[1.0, 0.0, 0.0]])
    camera = Camera(poses[0], MEASURED)
    for pose in poses[1:]:
        camera.take(pose, np.array([[0.0, 0.0, 0.0, 1e3]]), np.ones(1), 0.033)
    assert camera.seen[0, 0] == pytest.approx(poses[12 - KEPT, 0, 0] + NUMBERS.offset_ahead, abs=2e-3)


SHAPES = {
    "disc": disc((0.2, -0.1), 0.3),
    "segment": Obstacle(np.array([[-0.4, 0.1], [0.5, 0.3]]), 0.1),
    "bare segment": Obstacle(np.array([[-0.4, 0.1], [0.5, 0.3]])),
    "polygon": Obstacle(np.array([[-0.5, -0.4], [0.6, -0.3], [0.4, 0.5], [-0.3, 0.4]])),
    "round polygon": Obstacle(np.array([[0.4, 0.5], [0.6, -0.3], [-0.5, -0.4]]), 0.15),
}


def core_distance(vertices: np.ndarray, p: np.ndarray) -> float:
    """Signed distance from a convex core, by its edges, looked up at many points of them."""
    after = np.roll(vertices, -1, axis=0)
    edges = np.linspace(0.0, 1.0, 801)[:, None, None] * (after - vertices) + vertices
    away = float(np.linalg.norm(edges - p, axis=-1).min())
    if len(vertices) < 3:
        return away
    e, q = after - vertices, p - vertices
    return -away if (e[:, 0] * q[:, 1] - e[:, 1] * q[:, 0] > 0.0).all() else away


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(x=st.floats(-1.0, 1.0), y=st.floats(-1.0, 1.0))
def test_distances_from_obstacles_grow_along_the_direction_that_leads_away(name: str, x: float, y: float) -> None:
    shape, p = SHAPES[name], np.array([x, y])
    distance, away = shape.nearest(p)
    assert distance == pytest.approx(core_distance(shape.vertices, p) - shape.radius, abs=1e-3)
    assert distance == shape.distance(p)
    if abs(distance + shape.radius) > 1e-6:
        assert np.linalg.norm(away) == pytest.approx(1.0)
        assert shape.distance(p + 1e-6 * away) - distance == pytest.approx(1e-6, rel=1e-3)


@pytest.mark.parametrize("name", SHAPES)
def test_an_outline_lies_on_the_border_and_goes_all_the_way_round(name: str) -> None:
    shape = SHAPES[name]
    outline = shape.outline
    assert np.abs(shape.distance(outline)).max() < 1e-12
    middles = (outline[1:] + outline[:-1]) / 2.0
    assert (shape.distance(middles) > -0.01).all()
    if name != "bare segment":
        np.testing.assert_allclose(outline[0], outline[-1])
        inside = np.random.default_rng(0).uniform(-1.0, 1.0, (60_000, 2))
        share = (shape.distance(inside) < 0.0).mean() * 4.0
        px, py = outline.T
        assert abs(px[:-1] @ py[1:] - py[:-1] @ px[1:]) / 2.0 == pytest.approx(share, abs=0.02)


def test_polygons_are_turned_counter_clockwise_and_obstacles_packed_one_after_the_other() -> None:
    vertices = SHAPES["round polygon"].vertices
    e = np.roll(vertices, -1, axis=0) - vertices
    after = np.roll(e, -1, axis=0)
    assert (e[:, 0] * after[:, 1] - e[:, 1] * after[:, 0] > 0.0).all()
    packed, first, radii = pack(list(SHAPES.values()))
    assert first.tolist() == [0, 1, 3, 5, 9, 12]
    assert radii.tolist() == [0.3, 0.1, 0.0, 0.0, 0.15]
    np.testing.assert_array_equal(packed[5:9], SHAPES["polygon"].vertices)
    assert pack([])[0].shape == (0, 2)
