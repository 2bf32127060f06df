"""How near points and hulls come to walls and obstacles."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, Arena
from robots.obstacles import Obstacle, disc
from scenarios.definition.experiment import Experiment
from scenarios.measures.clearance import clearance, hull_distance, nearest_hulls, nearest_points, thing_name
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate

OBSTACLES = (
    disc((0.0, 0.0), 0.1),
    Obstacle(np.array([[-0.1, 0.0], [0.1, 0.05]]), 0.02),
    Obstacle(np.array([[-0.1, -0.1], [0.1, 0.0], [0.0, 0.1]])),
    Obstacle(np.array([[-0.6, -0.004], [0.6, -0.004], [0.6, 0.004], [-0.6, 0.004]])),
)
GRID = 21
ARENA = Arena((-1.0, 1.0), (-1.0, 1.0), True, OBSTACLES[:1])


def turned(outline: np.ndarray, pose: tuple[float, float, float]) -> np.ndarray:
    """An outline (q, 2) in the robot's frame, at a pose."""
    x, y, theta = pose
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    return np.asarray(outline @ turn.T + [x, y])


@given(
    st.sampled_from(OBSTACLES),
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-4.0, 4.0)),
)
def test_a_hull_is_as_far_from_an_obstacle_as_the_nearest_of_all_its_points(
    obstacle: Obstacle, pose: tuple[float, float, float]
) -> None:
    corners = turned(GTERNAL.chassis.outline, pose)
    along, across = (np.linspace(0.0, 1.0, GRID)[:, None] * (corners[k] - corners[0]) for k in (1, 3))
    nearest = obstacle.distance(corners[0] + along[:, None] + across[None]).min()
    found = hull_distance(obstacle, corners)
    assert (found <= 0.0) >= (nearest <= 0.0)
    if found > 0.0:
        assert found == pytest.approx(nearest, abs=GTERNAL.chassis.width / (GRID - 1))
        assert found <= nearest + 1e-12


def test_a_bar_across_a_hull_is_in_it_though_neither_has_a_corner_in_the_other() -> None:
    assert hull_distance(OBSTACLES[3], GTERNAL.chassis.outline) == pytest.approx(-0.059)


@given(st.lists(st.tuples(*[st.floats(-1.5, 1.5)] * 3), min_size=1, max_size=5))
def test_the_nearest_is_named_with_its_agent_and_its_thing(poses: list[tuple[float, float, float]]) -> None:
    states = np.array([poses])
    points, hulls = nearest_points(ARENA, states[..., :2]), nearest_hulls(ARENA, GTERNAL.chassis.outline, states)
    x, y = states[0, int(points.row[0]), :2]
    gaps = [y + 1.0, 1.0 - x, 1.0 - y, x + 1.0, float(np.hypot(x, y)) - 0.1]
    assert points.distance[0] == pytest.approx(gaps[int(points.thing[0])], abs=1e-12)
    assert points.distance[0] == pytest.approx(min(gaps), abs=1e-12)
    corners = turned(GTERNAL.chassis.outline, poses[int(hulls.row[0])])
    assert hulls.distance[0] <= min((1.0 - np.abs(corners)).min(), OBSTACLES[0].distance(corners).min()) + 1e-12


def test_walls_and_obstacles_are_named_as_everywhere() -> None:
    assert [thing_name(k) for k in (0, 3, 4, 5)] == ["south wall", "west wall", "obstacle 1", "obstacle 2"]


def test_long_runs_are_looked_at_in_parts_that_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    poses = np.random.default_rng(0).uniform(-1.0, 1.0, (9, 4, 3))
    whole = nearest_hulls(ARENA, GTERNAL.chassis.outline, poses)
    monkeypatch.setattr("scenarios.measures.clearance.MOST_STATES", 8)
    parts = nearest_hulls(ARENA, GTERNAL.chassis.outline, poses)
    np.testing.assert_array_equal(whole.distance, parts.distance)
    np.testing.assert_array_equal(whole.thing, parts.thing)


def test_a_result_tells_both_with_time_agent_and_thing(varied: Callable[..., Experiment]) -> None:
    experiment = varied("arena.walls=true", "plant.name=saturated", duration=2.0)
    trajectory = simulate(experiment, 0)
    found = result(experiment, 0, trajectory, measure(experiment, trajectory))["clearance"]
    assert set(found) == {"point", "hull"}
    step = int(np.argmin(np.abs(trajectory.t - found["point"]["time_s"])))
    x, y = trajectory.points[step, found["point"]["agent"] - 1]
    gap = {"north wall": 1.0 - y, "south wall": 1.0 + y, "east wall": 1.6 - x, "west wall": 1.6 + x}
    assert found["point"]["distance_m"] == pytest.approx(gap[found["point"]["thing"]])
    assert found["hull"]["distance_m"] < found["point"]["distance_m"]


def test_a_floor_with_neither_walls_nor_obstacles_has_no_clearance_and_points_have_no_hulls(
    varied: Callable[..., Experiment],
) -> None:
    free = varied("arena.walls=false", "plant.name=saturated", duration=0.1)
    assert clearance(free, simulate(free, 0)) is None
    points = varied("arena.walls=true", "plant.name=single_integrator", duration=0.1)
    found = clearance(points, simulate(points, 0))
    assert found is not None
    assert found.hulls is None


def test_an_obstacle_that_is_there_for_a_while_counts_as_long_as_it_is_there() -> None:
    floor, there = (
        Arena((-1.0, 1.0), (-1.0, 1.0), False, (disc((0.3, 0.7), 0.1),)),
        np.array([[False], [True], [False]]),
    )
    found = nearest_points(floor, np.full((3, 1, 2), 0.3), there)
    np.testing.assert_allclose(found.distance, [np.inf, 0.3, np.inf])
    assert found.thing[1] == 4


def test_a_state_that_is_no_number_is_nowhere_near() -> None:
    points = np.zeros((3, 1, 2))
    points[0], points[1], points[2] = 0.5, 0.9, np.nan
    assert nearest_points(Arena((-1.0, 1.0), (-1.0, 1.0)), points).lowest == 1
