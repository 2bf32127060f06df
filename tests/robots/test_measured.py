"""The measured robot: its wheel loop, its link, its cameras, and that nominal robots know nothing of it."""

from dataclasses import replace

import numpy as np
import pytest

from robots import GTERNAL, NearIdentityDiffeomorphism
from robots.identification.numbers import TURN
from robots.measured import MEASURED, MeasuredModel
from robots.measured.camera import Camera
from robots.measured.link import Link
from robots.measured.wheels import WheelLoop
from robots.model import CONTROL_PERIOD, ENCODER_COUNTS_PER_TURN
from robots.worlds import make_world
from robots.worlds.protocol import Real, World

NID = NearIdentityDiffeomorphism(0.025)
QUIET = replace(
    MEASURED,
    numbers=replace(
        MEASURED.numbers,
        **dict.fromkeys(
            ("jitter", "position_noise", "heading_noise", "slip_along", "slip_heading", "slip_turning", "stale"), 0.0
        ),
    ),
    base_spread=0.0,
    radius_spread=0.0,
    command_loss=0.0,
)
SPEED_OF_A_COUNT = 2.0 * np.pi / ENCODER_COUNTS_PER_TURN / MEASURED.loop_period


def world(model: MeasuredModel | None, plant: str = "saturated", seed: int = 0, robots: int = 2) -> World:
    points = np.stack([np.arange(robots, dtype=float) - 0.5, np.zeros(robots)], axis=1)
    generators = [np.random.default_rng(seed)]
    return make_world(plant, points, np.zeros(robots), nid=NID, robot=GTERNAL, measured=model, generators=generators)


def driven(body: World, v: float, omega: float, periods: int) -> World:
    velocity = np.tile([v, NID.projection_distance * omega], (body.poses.shape[-2], 1))
    for _ in range(periods):
        body.step(lambda points, headings, _: velocity, CONTROL_PERIOD)
    return body


@pytest.mark.parametrize("wish", [0.6, -3.0, 9.0, 12.5])
def test_the_wheel_loop_holds_the_wish_to_a_step_of_the_pwm_and_to_four_counts(wish: float) -> None:
    loop = WheelLoop((1, 2), MEASURED)
    told = np.full((1, 2), wish)
    speeds = [loop.advance(told, told, 0.0, CONTROL_PERIOD).copy() for _ in range(400)]
    late = np.array(speeds[100:])
    assert late.mean() == pytest.approx(wish, abs=MEASURED.full_speed / MEASURED.largest_pwm)
    assert np.abs(late - wish).max() < 4.0 * SPEED_OF_A_COUNT


def test_a_wheel_needs_time_and_its_pwm_is_slewed() -> None:
    loop = WheelLoop((1, 2), MEASURED)
    told = np.full((1, 2), 12.5)
    # One turn of the loop decides at most 50 of 255, the next one applies it.
    first = loop.advance(told, told, 0.0, MEASURED.loop_period)
    assert np.all(first == 0.0)
    second = loop.advance(told, told, 0.0, MEASURED.loop_period)
    assert np.all(second < MEASURED.full_speed * 50.0 / 255.0 * MEASURED.loop_period / MEASURED.motor_lag)


def test_motors_that_are_off_run_out() -> None:
    loop = WheelLoop((1, 2), MEASURED)
    told, off = np.full((1, 2), 8.0), np.full((1, 2), np.nan)
    for _ in range(60):
        loop.advance(told, told, 0.0, CONTROL_PERIOD)
    for _ in range(30):
        loop.advance(off, off, 0.0, CONTROL_PERIOD)
    assert np.abs(loop.speed).max() < 1e-6


def test_a_robot_keeps_its_last_command_until_it_times_out() -> None:
    link = Link((1,), GTERNAL.drive, MEASURED)
    wish = np.array([[5.0, 6.0]])
    heard, lost = np.array([0.99]), np.array([0.0])
    assert np.array_equal(link.send(wish, heard, CONTROL_PERIOD), wish)
    silent = [link.send(-wish, lost, CONTROL_PERIOD).copy() for _ in range(20)]
    held = [bool(np.array_equal(told, wish)) for told in silent]
    assert held == [(k + 1) * CONTROL_PERIOD <= MEASURED.time_out for k in range(20)]
    assert np.isnan(silent[-1]).all()


def test_commands_below_the_firmwares_threshold_leave_the_motors_off() -> None:
    link = Link((1,), GTERNAL.drive, MEASURED)
    still = GTERNAL.drive.wheel_speeds(np.array([[0.9e-4, 0.009]]))
    assert np.isnan(link.send(still, np.array([0.9]), CONTROL_PERIOD)).all()
    moving = GTERNAL.drive.wheel_speeds(np.array([[0.0, 0.011]]))
    assert np.isfinite(link.send(moving, np.array([0.9]), CONTROL_PERIOD)).all()


def test_cameras_are_late_by_their_latency_and_see_the_tracked_point() -> None:
    camera = Camera(np.zeros((1, 3)), replace(QUIET, numbers=replace(QUIET.numbers, stale=0.5)))
    speed = 0.1
    for k in range(1, 11):
        camera.take(np.array([[speed * k * CONTROL_PERIOD, 0.0, 0.0]]), np.zeros((1, 4)), np.ones(1), CONTROL_PERIOD)
    late = 10 * CONTROL_PERIOD - QUIET.camera_latency
    assert camera.seen[0, 0] == pytest.approx(speed * late + QUIET.numbers.offset_ahead, abs=1e-12)
    assert camera.seen[0, 2] == pytest.approx(QUIET.numbers.marker_angle, abs=5e-4)
    before = camera.seen.copy()
    camera.take(np.ones((1, 3)), np.zeros((1, 4)), np.zeros(1), CONTROL_PERIOD)
    assert np.array_equal(camera.seen, before)


def test_the_cameras_jitter_has_the_logs_deviation() -> None:
    model = replace(QUIET, numbers=replace(QUIET.numbers, jitter=0.3), camera_latency=0.08)
    camera, rng = Camera(np.zeros((400, 3)), model), np.random.default_rng(0)
    for k in range(1, 60):
        poses = np.zeros((400, 3))
        poses[:, 0] = k * CONTROL_PERIOD
        camera.take(poses, rng.standard_normal((400, 4)), np.ones(400), CONTROL_PERIOD)
    assert camera.seen[:, 0].std() == pytest.approx(0.3 * TURN, rel=0.15)


def test_a_robot_turns_faster_than_commanded_by_the_ratio_of_the_bases() -> None:
    body = driven(world(QUIET), 0.0, 1.5, 200)
    nominal = 1.5 * 200 * CONTROL_PERIOD
    start_up = 0.1  # rad, that the motors' lag and the command's delay cost
    assert body.poses[0, 2] == pytest.approx(nominal * 0.11 / QUIET.numbers.base_length, abs=start_up)
    assert body.poses[0, 2] > nominal


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_measured_robots_follow_commands_on_both_worlds(plant: str) -> None:
    body = driven(world(MEASURED, plant), 0.1, 0.0, 100)
    assert body.poses[:, 0] - [-0.525, 0.475] == pytest.approx([0.33, 0.33], abs=0.03)
    seen, _ = body.seen
    assert np.abs(seen - body.points).max() < 0.02


def test_robots_differ_by_the_spread_and_their_streams_are_their_own() -> None:
    body = world(MEASURED, robots=300)
    base, radius = body.base, body.radius  # type: ignore[attr-defined]
    assert base.std() / base.mean() == pytest.approx(0.01, rel=0.15)
    assert radius.std() / radius.mean() == pytest.approx(0.005, rel=0.15)
    rng, twin = np.random.default_rng(4), np.random.default_rng(4)
    points = np.zeros((2, 2))
    make_world("saturated", points, np.zeros(2), nid=NID, robot=GTERNAL, measured=MEASURED, generators=[rng])
    assert rng.random() == twin.random()  # the run's own draws are what they were


def test_the_same_seed_gives_the_same_motion_and_another_does_not() -> None:
    one, again, other = (driven(world(MEASURED, seed=seed), 0.1, 0.5, 80).poses for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_a_batch_moves_its_runs_as_they_move_alone() -> None:
    points, theta = np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros(2)
    generators = [np.random.default_rng(seed) for seed in (7, 8)]
    stacked = np.stack([points, points]), np.stack([theta, theta])
    batch = make_world("saturated", *stacked, nid=NID, robot=GTERNAL, measured=MEASURED, generators=generators)

    def controller(points: Real, headings: Real, elapsed: float) -> Real:
        return np.broadcast_to(np.array([0.08, 0.01]), points.shape)

    alone = []
    for seed in (7, 8):
        rng = [np.random.default_rng(seed)]
        alone.append(make_world("saturated", points, theta, nid=NID, robot=GTERNAL, measured=MEASURED, generators=rng))
    for _ in range(70):
        for body in (batch, *alone):
            body.step(controller, CONTROL_PERIOD)
    assert np.array_equal(batch.poses, np.stack([body.poses for body in alone]))


def test_measured_robots_need_wheels() -> None:
    with pytest.raises(ValueError, match="saturated or pymunk"):
        world(MEASURED, "unicycle")
