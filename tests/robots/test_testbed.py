"""The testbed's rules, on trajectories made by hand."""

import numpy as np
import pytest

from robots import GTERNAL, ROBOTARIUM_FLOOR, judge
from robots.testbed import COLLISION_DISTANCE, collision_centres, separation

T = np.arange(5) * 0.033


def run(*robots: list[tuple[float, float, float]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Five steps of robots that stand at (x, y, theta), wheels still."""
    poses = np.tile(np.array(robots, dtype=float).reshape(1, -1, 3), (5, 1, 1))
    return T, poses, np.zeros((5, poses.shape[1], 2))


def test_robots_that_stand_apart_on_the_floor_are_accepted() -> None:
    verdict = judge(*run([(0.0, 0.0, 0.0)], [(0.5, 0.0, 1.0)]))
    assert verdict.accepted
    assert verdict.violations == ()


def test_it_is_the_axle_centre_that_must_stay_on_the_floor() -> None:
    assert judge(*run([(1.6, 0.0, 0.0)])).accepted, "the collision centre is beyond the floor, the axle is not"
    assert not judge(*run([(1.6001, 0.0, np.pi)])).accepted


def test_leaving_the_floor_is_reported_once_with_its_first_step_and_how_far() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)], [(0.5, 0.9, 0.0)])
    poses[2:, 1, 1] = 1.05
    (violation,) = judge(t, poses, wheels).violations
    assert (violation.kind, violation.steps, violation.first.robots) == ("floor", 3, (1,))
    assert violation.first == violation.worst
    assert violation.first.time == t[2]
    assert violation.first.place == (0.5, 1.05)
    assert violation.first.value == pytest.approx(0.05)


def test_the_worst_of_a_violation_is_told_beside_the_first() -> None:
    """A robot that drives off the floor, and another that is further off for one step."""
    t, poses, wheels = run([(0.0, 0.0, 0.0)], [(0.5, 0.9, 0.0)])
    poses[1:, 0, 0] = [1.601, 1.7, 1.903, 1.8]
    poses[2, 1, 1] = -1.31
    (violation,) = judge(t, poses, wheels).violations
    assert violation.steps == 4
    assert (violation.first.time, violation.first.robots) == (t[1], (0,))
    assert violation.first.value == pytest.approx(0.001)
    assert (violation.worst.time, violation.worst.robots) == (t[2], (1,))
    assert violation.worst.value == pytest.approx(0.31)
    assert violation.worst.place == (0.5, -1.31)


def test_the_worst_collision_is_the_nearest_and_the_worst_wheel_the_fastest() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)], [(0.13, 0.0, 0.0)], [(0.0, 0.5, 0.0)])
    poses[2, 2, :2] = 0.02, 0.11
    poses[3, 2, :2] = 0.0, 0.05
    wheels[1, 0], wheels[4, 2] = (12.7, 0.0), (0.0, -19.0)
    collision, actuator = judge(t, poses, wheels).violations
    assert (collision.steps, collision.first.robots, collision.first.time) == (5, (0, 1), t[0])
    assert (collision.worst.robots, collision.worst.time) == ((0, 2), t[3])
    assert collision.worst.value == pytest.approx(0.05)
    assert (actuator.steps, actuator.first.value, actuator.first.robots) == (2, 12.7, (0,))
    assert (actuator.worst.value, actuator.worst.robots, actuator.worst.time) == (19.0, (2,), t[4])


@pytest.mark.parametrize(("speed", "warns"), [(0.2, False), (0.2 + 1e-12, True)])
def test_a_command_is_beyond_the_wheels_where_the_testbed_says_so(speed: float, warns: bool) -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)])
    wheels[:] = GTERNAL.drive.wheel_speeds(np.array([speed, 0.0]))
    assert [v.kind for v in judge(t, poses, wheels).violations] == ["actuator"] * warns


def test_it_is_the_distance_of_the_collision_centres_that_counts() -> None:
    """Two robots 0.15 m apart: back to back their collision centres are 0.2 m apart, face to face 0.1 m."""
    assert judge(*run([(0.0, 0.0, np.pi)], [(0.15, 0.0, 0.0)])).accepted
    verdict = judge(*run([(0.0, 0.0, 0.0)], [(0.15, 0.0, np.pi)]))
    assert not verdict.accepted
    (violation,) = verdict.violations
    assert (violation.kind, violation.steps, violation.first.robots) == ("collision", 5, (0, 1))
    assert violation.first.value == pytest.approx(0.1)
    assert violation.first.place == pytest.approx((0.075, 0.0))


@pytest.mark.parametrize(
    ("gap", "accepted"),
    [(COLLISION_DISTANCE + 1e-9, True), (COLLISION_DISTANCE, False), (COLLISION_DISTANCE - 1e-9, False)],
)
def test_the_collision_distance_is_the_border(gap: float, accepted: bool) -> None:
    assert judge(*run([(0.0, 0.0, 0.0)], [(gap, 0.0, 0.0)])).accepted == accepted


def test_a_wheel_beyond_its_limit_is_a_warning_and_rejects_nothing() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)], [(0.5, 0.0, 0.0)])
    wheels[1:3, 1, 0] = -12.6
    verdict = judge(t, poses, wheels)
    assert verdict.accepted
    (violation,) = verdict.violations
    assert (violation.kind, violation.steps, violation.first.robots, violation.first.value) == (
        "actuator",
        2,
        (1,),
        12.6,
    )


def test_driving_at_the_limit_itself_is_no_violation() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)])
    wheels[:] = GTERNAL.drive.saturate(np.array([40.0, 39.0]), "scale")
    assert judge(t, poses, wheels).violations == ()


def test_plants_without_wheels_cannot_break_the_rule_of_the_wheels() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)])
    assert judge(t, poses, np.full_like(wheels, np.nan)).violations == ()


def test_a_run_that_ends_in_no_number_is_rejected() -> None:
    t, poses, wheels = run([(0.0, 0.0, 0.0)])
    poses[-1] = np.nan
    (violation,) = judge(t, poses, wheels).violations
    assert (violation.kind, violation.steps, violation.worst.time) == ("floor", 1, t[-1])


def test_every_kind_is_reported_beside_the_others() -> None:
    t, poses, wheels = run([(1.7, 0.0, 0.0)], [(1.7, 0.05, 0.0)])
    wheels[:] = 20.0
    assert [v.kind for v in judge(t, poses, wheels).violations] == ["floor", "collision", "actuator"]


def test_another_floor_is_judged_by_its_own_sides() -> None:
    import dataclasses

    wide = dataclasses.replace(ROBOTARIUM_FLOOR, x=(-5.0, 5.0))
    assert judge(*run([(3.0, 0.0, 0.0)]), floor=wide).accepted


def test_the_closest_pair_is_found_among_all_at_every_time() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(50, 6, 2))
    near = separation(points)
    for k in range(50):
        distances = {(i, j): np.linalg.norm(points[k, i] - points[k, j]) for i in range(6) for j in range(i + 1, 6)}
        assert near.distance[k] == pytest.approx(min(distances.values()))
        assert tuple(near.pairs[k]) == min(distances, key=distances.__getitem__)


def test_a_robot_alone_is_infinitely_far_from_all_others() -> None:
    assert np.isinf(separation(np.zeros((3, 1, 2))).distance).all()
    assert judge(*run([(0.0, 0.0, 0.0)])).accepted


def test_collision_centres_lie_ahead_of_the_axle() -> None:
    np.testing.assert_allclose(collision_centres(np.array([1.0, 2.0, np.pi / 2.0])), [1.0, 2.025], atol=1e-15)
