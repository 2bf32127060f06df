"""One geometry for the filter, the world and the verdict."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism, judge, make_world
from robots.obstacles import Obstacle, disc
from robots.safety import things
from robots.testbed import collision_centres
from robots.worlds.contact import Contact

NID = NearIdentityDiffeomorphism(0.025)
coordinates = st.floats(-2.0, 2.0)
points = st.tuples(coordinates, coordinates)
SHAPES = {
    "disc": Obstacle(np.array([[0.3, -0.2]]), 0.25),
    "bar": Obstacle(np.array([[-0.5, 0.1], [0.6, 0.4]]), 0.05),
    "line": Obstacle(np.array([[-0.5, 0.1], [0.6, 0.4]])),
    "block": Obstacle(np.array([[0.0, 0.0], [0.8, 0.1], [0.7, 0.6], [-0.1, 0.5]])),
    "round block": Obstacle(np.array([[0.0, 0.0], [0.8, 0.1], [0.2, 0.7]]), 0.1),
}
shapes = pytest.mark.parametrize("name", SHAPES)


@shapes
@given(point=points)
def test_the_compiled_distance_is_the_public_one(name: str, point: tuple[float, float]) -> None:
    obstacle = SHAPES[name]
    distance, away = obstacle.nearest(point)
    core, x, y = things.nearest_on_obstacle(obstacle.vertices, *point)
    assert core - obstacle.radius == pytest.approx(float(distance), abs=1e-12)
    assume(abs(core) > 1e-6)
    # On the medial axis inside a polygon two sides are equally near: either direction is right.
    step = 1e-7
    for direction in ((x, y), away):
        beyond = float(obstacle.distance(np.array(point) + step * np.asarray(direction)))
        assert beyond - float(distance) == pytest.approx(step, abs=2e-9)


@shapes
@given(point=points)
def test_the_world_has_the_same_distance(name: str, point: tuple[float, float]) -> None:
    obstacle = SHAPES[name]
    space = contact(obstacle).space
    static = [shape for shape in space.shapes if shape.body is space.static_body]
    assert len(static) == 1
    found = static[0].point_query(point).distance
    distance = float(obstacle.distance(point))
    assume(distance > 1e-6)
    assert found == pytest.approx(distance, abs=1e-6)


def contact(*obstacles: Obstacle) -> Contact:
    arena = Arena((-9.0, 9.0), (-9.0, 9.0), False, obstacles)
    return Contact(np.array([[5.0, 5.0, 0.0]]), NID, GTERNAL, arena=arena)


@shapes
def test_the_outline_is_the_border(name: str) -> None:
    outline = SHAPES[name].outline
    np.testing.assert_allclose(SHAPES[name].distance(outline), 0.0, atol=1e-12)


@given(point=points)
def test_inside_a_block_the_distance_is_negative(point: tuple[float, float]) -> None:
    obstacle = SHAPES["block"]
    space = pymunk.Space()
    poly = pymunk.Poly(space.static_body, [tuple(v) for v in obstacle.vertices.tolist()])
    space.add(poly)
    found = poly.point_query(point).distance
    assume(abs(found) > 1e-6)
    assert (float(obstacle.distance(point)) < 0.0) == (found < 0.0)


def test_the_order_of_a_polygon_does_not_matter() -> None:
    corners = SHAPES["block"].vertices
    np.testing.assert_array_equal(Obstacle(corners[::-1]).distance([3.0, 1.0]), Obstacle(corners).distance([3.0, 1.0]))


@pytest.mark.parametrize(
    ("vertices", "radius", "message"),
    [
        ([[0.0, 0.0]], 0.0, "radius of a disc"),
        ([[0.0, 0.0]], -1.0, "radius"),
        ([[0.0, np.nan]], 1.0, "finite"),
        ([[1.0, 1.0], [1.0, 1.0]], 0.1, "ends of a segment"),
        ([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0, "convex"),
        ([[0.0, 0.0], [2.0, 0.0], [1.0, 0.5], [1.0, 2.0]], 0.0, "convex"),
        ([[0.0, 1.0], [0.6, -0.8], [-0.95, 0.3], [0.95, 0.3], [-0.6, -0.8]], 0.0, "crossing"),
        (np.zeros((0, 2)), 0.1, "shape"),
    ],
)
def test_what_is_no_obstacle_is_refused(vertices: object, radius: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Obstacle(np.array(vertices, dtype=float), radius)


def test_a_robot_that_drives_at_an_obstacle_is_stopped_and_the_verdict_says_so() -> None:
    arena = Arena((-1.6, 1.6), (-1.0, 1.0), False, (disc((0.4, 0.0), 0.1),))
    world = make_world("pymunk", np.zeros((1, 2)), np.zeros(1), nid=NID, robot=GTERNAL, arena=arena)
    poses = [world.poses.copy()]
    for _ in range(120):
        world.step(lambda p, h, _: np.array([[0.15, 0.0]]), 0.033)
        poses.append(world.poses.copy())
    front = world.points[0, 0] + GTERNAL.chassis.length / 2.0
    assert front == pytest.approx(0.3, abs=0.003)
    t = 0.033 * np.arange(len(poses))
    verdict = judge(t, np.array(poses), np.zeros((len(poses), 1, 2)), arena)
    assert not verdict.accepted
    (violation,) = verdict.violations
    assert violation.kind == "obstacle"
    assert violation.first.robots == (0,)
    assert violation.first.value <= 0.0675
    gaps = np.hypot(*(collision_centres(np.array(poses))[:, 0] - [0.4, 0.0]).T) - 0.1
    assert violation.steps == (gaps <= 0.0675).sum()
    assert violation.worst.value == pytest.approx(gaps.min())
    assert violation.first.time == t[int((gaps <= 0.0675).argmax())]
