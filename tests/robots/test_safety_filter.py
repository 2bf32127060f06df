"""What the filters promise beyond the barrier: locality, symmetry, answers in trouble, deadlocks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism, make_world
from robots.obstacles import disc
from robots.safety import FILTERS, FilterSettings, Noise, make_filter
from robots.safety.protocol import WALLS
from robots.senses.chance import pair

NID = NearIdentityDiffeomorphism(0.025)
PERIOD = 0.033
seeds = st.integers(0, 10**6)


def build(shape: tuple[int, ...], name: str = "decentralised", arena: Arena | None = None):
    return make_filter(name, shape, GTERNAL.drive, NID, FilterSettings(), arena)


def crowd(n: int, rng: np.random.Generator, side: float = 0.2) -> tuple[np.ndarray, ...]:
    """Points, headings, feedback and common velocity of n robots, about one in every square of a side."""
    points = rng.uniform(0.0, side * np.sqrt(n), (n, 2))
    theta = rng.uniform(-np.pi, np.pi, n)
    headings = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    return points, headings, rng.normal(0.0, 0.2, (n, 2)), rng.normal(0.0, 0.02, (n, 2))


def head_on(distance: float) -> tuple[np.ndarray, ...]:
    points = np.array([[0.0, 0.0], [distance, 0.0]])
    headings = np.array([[1.0, 0.0], [-1.0, 0.0]])
    return points, headings, np.array([[0.2, 0.0], [0.2, 0.0]]), np.zeros((2, 2))


@given(seed=seeds, angle=st.floats(-np.pi, np.pi))
def test_a_turned_and_shifted_world_gives_the_same_body_velocities(seed: int, angle: float) -> None:
    points, headings, feedback, common = crowd(12, np.random.default_rng(seed))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    u = build((12,)).filter(points, headings, feedback, common, PERIOD)
    turned = build((12,)).filter(points @ turn.T + [5.0, -7.0], headings @ turn.T, feedback, common, PERIOD)
    np.testing.assert_allclose(turned, u, atol=1e-6)


@given(seed=seeds)
def test_a_robot_uses_nothing_but_what_lies_within_its_sensing_range(seed: int) -> None:
    points, headings, feedback, common = crowd(40, np.random.default_rng(seed))
    u = build((40,)).filter(points, headings, feedback, common, PERIOD)
    for robot in range(0, 40, 7):
        near = np.flatnonzero(np.linalg.norm(points - points[robot], axis=1) < FilterSettings().sensing_range)
        blind = np.full_like(feedback, np.nan)
        blind[robot] = feedback[robot]
        alone = build((len(near),)).filter(points[near], headings[near], blind[near], common[near], PERIOD)
        np.testing.assert_allclose(alone[near == robot][0], u[robot], atol=1e-6)


@given(seed=seeds)
def test_the_neighbour_search_finds_what_all_pairs_find(seed: int) -> None:
    """Robots far off change which cells share a bucket, and nothing else."""
    points, headings, feedback, common = crowd(30, np.random.default_rng(seed))
    far = np.random.default_rng(seed + 1).uniform(50.0, 5000.0, (200, 2))
    u = build((30,)).filter(points, headings, feedback, common, PERIOD)
    many = [np.concatenate([a, b]) for a, b in ((points, far), (headings, np.tile([1.0, 0.0], (200, 1))))]
    still = [np.concatenate([a, np.zeros((200, 2))]) for a in (feedback, common)]
    np.testing.assert_allclose(build((230,)).filter(*many, *still, PERIOD)[:30], u, atol=1e-6)


@given(seed=seeds)
def test_a_batch_equals_its_single_runs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    runs = [crowd(6, rng) for _ in range(3)]
    batch = build((3, 6))
    singles = [build((6,)) for _ in range(3)]
    for _ in range(5):
        u = batch.filter(*(np.stack(part) for part in zip(*runs, strict=True)), PERIOD)
        for row, (single, run) in enumerate(zip(singles, runs, strict=True)):
            np.testing.assert_array_equal(single.filter(*run, PERIOD), u[row])
            np.testing.assert_array_equal(single.stuck, batch.stuck[row])


@pytest.mark.parametrize("name", FILTERS[1:])
def test_a_robot_without_others_near_drives_as_its_law_wants(name: str) -> None:
    feedback = np.array([[0.05, 0.01], [-0.05, 0.02]])
    points, headings = np.array([[-0.7, 0.0], [0.7, 0.0]]), np.array([[1.0, 0.0], [0.0, 1.0]])
    safety = build((2,), name)
    np.testing.assert_allclose(
        safety.filter(points, headings, feedback, np.zeros((2, 2)), PERIOD), feedback, atol=1e-12
    )
    assert (safety.intervention <= 1e-12).all()


@given(seed=seeds)
def test_every_command_is_within_the_wheels_limits(seed: int) -> None:
    points, headings, feedback, common = crowd(20, np.random.default_rng(seed), side=0.1)
    u = build((20,)).filter(points, headings, 10.0 * feedback, common, PERIOD)
    wheels = GTERNAL.drive.wheel_speeds(NID.twist(u))
    assert np.abs(wheels).max() <= GTERNAL.drive.wheel_speed_limit


@given(seed=seeds)
def test_while_robots_are_apart_no_problem_is_infeasible(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) * 0.156
    _, headings, feedback, _ = crowd(16, rng)
    v_r = rng.uniform(-0.02, 0.02, 2)
    common = np.stack([headings @ v_r, headings[:, 0] * v_r[1] - headings[:, 1] * v_r[0]], axis=1)
    safety = build((16,))
    safety.filter(grid, headings, feedback, common, PERIOD)
    assert (safety.relaxation == 0.0).all()


def trapped() -> tuple[np.ndarray, ...]:
    """Robot 0 much too close to robots 1 and 2 on both sides; robots 3 and 4 meet head-on elsewhere."""
    points = np.array([[0.0, 0.0], [0.05, 0.0], [-0.05, 0.0], [2.0, 0.0], [2.2, 0.0]])
    headings = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [-1.0, 0.0]])
    return points, headings, np.array([[0.1, 0.0]] * 5), np.zeros((5, 2))


@pytest.mark.parametrize("name", ["decentralised", "centralised"])
def test_an_infeasible_problem_is_answered_named_and_kept_from_the_others(name: str) -> None:
    points, headings, feedback, common = trapped()
    safety = build((5,), name)
    u = safety.filter(points, headings, feedback, common, PERIOD)
    assert np.isfinite(u).all()
    assert safety.relaxation[0] > 0.0
    assert set(safety.blockers[0]) == {1, 2, -1}
    assert (safety.relaxation[3:] == 0.0).all()
    pair = build((2,), name).filter(points[3:], headings[3:], feedback[3:], common[3:], PERIOD)
    np.testing.assert_allclose(u[3:], pair, atol=1e-9)


def test_walls_and_obstacles_are_named_when_they_leave_no_way() -> None:
    arena = Arena((-1.0, 1.0), (0.0, 2.0), True, (disc((0.0, 0.22), 0.1),))
    safety = build((1,), arena=arena)
    safety.filter(np.array([[0.0, 0.06]]), np.array([[1.0, 0.0]]), np.zeros((1, 2)), np.zeros((1, 2)), PERIOD)
    assert safety.relaxation[0] > 0.0
    assert set(safety.blockers[0]) == {1, 1 + WALLS, -1}


def test_a_robot_that_is_nowhere_stops_no_other() -> None:
    points, headings, feedback, common = head_on(0.2)
    u = build((2,)).filter(points, headings, feedback, common, PERIOD)
    lost = [np.concatenate([a, np.full((1, 2), np.nan)]) for a in (points, headings, feedback, common)]
    beside = build((3,)).filter(*lost, PERIOD)
    np.testing.assert_array_equal(beside[:2], u)
    assert np.isnan(beside[2]).all()


def test_a_robot_that_cannot_move_is_declared_stuck_and_tries_the_other_side_in_the_end() -> None:
    points = np.array([[0.0, 0.0], [0.155, 0.0], [-0.155, 0.0], [0.0, 0.155], [0.0, -0.155]])
    headings = np.tile([1.0, 0.0], (5, 1))
    feedback = np.zeros((5, 2))
    feedback[0] = 0.1, 0.0
    safety = build((5,))
    waits = []
    for _ in range(200):
        safety.filter(points, headings, feedback, np.zeros((5, 2)), PERIOD)
        waits.append(safety.stuck[0])
    assert max(waits) > FilterSettings().stuck_time
    assert np.diff(waits).min() < -1.0  # the turn starts again, on the other side
    assert (safety.stuck[1:] == 0.0).all()


def test_a_robot_in_a_notch_gets_out_on_the_right_when_the_left_leads_deeper_into_it() -> None:
    """Robots 1 and 2 stand still, the place of robot 0 lies beyond robot 2. Once it has come here turned far to the
    left, which is where they both are, it would wait for ever."""
    start = np.array([[0.269, -0.417], [0.376, -0.529], [0.152, -0.519]])
    goal = np.array([[0.045, -0.401], *start[1:]])
    world = make_world("saturated", start, np.zeros(3), nid=NID, robot=GTERNAL)
    safety = build((3,))
    safety.stuck[0] = 4.0

    def controller(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
        away = 0.6 * (goal - points)
        body = (away.view(np.complex128) * np.conj(headings.view(np.complex128))).view(np.float64)
        return safety.filter(points, headings, body, np.zeros((3, 2)), PERIOD)

    for _ in range(1000):
        world.step(controller, PERIOD)
    np.testing.assert_allclose(world.points, goal, atol=1e-3)


def test_two_robots_that_meet_head_on_pass_on_the_left_of_their_way() -> None:
    points, headings, feedback, common = head_on(0.2)
    u = build((2,)).filter(points, headings, feedback, common, PERIOD)
    assert (u[:, 1] > 0.0).all()


def test_the_filter_acts_on_what_is_measured() -> None:
    """An offset in the measurement of the other robot does the same as that robot in another place."""
    points, headings, feedback, common = head_on(0.25)
    key = np.uint64(7)
    offset = np.array(pair(key, 0, 1, 0.05, 0.0)[2:])  # the heading of robot 0 is the x axis
    moved = points + [[0.0, 0.0], offset]
    seen = build((2,)).filter(points, headings, feedback, common, PERIOD, Noise(np.array(key), 0.05, 0.0))
    there = build((2,)).filter(moved, headings, feedback, common, PERIOD)
    np.testing.assert_allclose(seen[0], there[0], atol=1e-9)


def test_an_unknown_filter_is_refused() -> None:
    with pytest.raises(ValueError, match="safety must be one of none, decentralised"):
        build((2,), "magic")


@pytest.mark.parametrize(
    ("field", "value"),
    [("safe_distance", 0.0), ("gain", np.nan), ("turn", -0.1), ("sensing_range", 0.1), ("clearance", -1.0)],
)
def test_settings_that_make_no_sense_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        FilterSettings(**{field: value})
