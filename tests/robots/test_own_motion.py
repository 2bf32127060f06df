"""Old measurements are carried into today's frame and place by what a robot knows of its own motion."""

import numpy as np
import pytest

from robots.nid import NearIdentityDiffeomorphism
from robots.own_motion import KNOWLEDGE, MEASURED, TURN, UNKNOWN, OwnMotion
from robots.safety import FilterSettings, delayed_settings
from robots.sensors import RelativePositionSensor

PERIOD = 0.033


def states(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    rng = np.random.default_rng(1)
    points, theta = rng.normal(size=(count, 3, 2)), rng.uniform(-3.0, 3.0, (count, 3))
    return list(zip(points, np.stack([np.cos(theta), np.sin(theta)], axis=-1), strict=True))


def after(own: OwnMotion, seen: list[tuple[np.ndarray, np.ndarray]], seed: int = 0) -> OwnMotion:
    rng = np.random.default_rng(seed)
    for points, headings in seen:
        own.begin_period(points, headings, PERIOD, [rng])
    return own


@pytest.mark.parametrize("knows", KNOWLEDGE)
def test_without_delay_everything_is_as_it_is_now(knows: str) -> None:
    seen = states(3)
    sensed = after(OwnMotion(0, knows, 1.0, 1.0), seen).sense(*seen[-1])
    assert sensed.own is sensed.others is seen[-1][0]
    assert sensed.headings is seen[-1][1]


@pytest.mark.parametrize(("knows", "own", "frame"), [(UNKNOWN, 1, 1), (TURN, 1, 4), (MEASURED, 4, 4)])
def test_what_is_known_is_undone_and_the_others_are_where_they_were(knows: str, own: int, frame: int) -> None:
    seen = states(5)
    sensed = after(OwnMotion(3, knows), seen).sense(*seen[-1])
    np.testing.assert_array_equal(sensed.own, seen[own][0])
    np.testing.assert_array_equal(sensed.headings, seen[frame][1])
    np.testing.assert_array_equal(sensed.others, seen[1][0])


def test_a_robot_that_knows_its_motion_sees_a_thing_at_rest_where_it_is() -> None:
    seen = states(5)
    thing = np.array([0.3, 0.4])
    for points, _ in seen:
        points[2] = thing
    sensed = after(OwnMotion(3, MEASURED), seen).sense(*seen[-1])
    sensor = RelativePositionSensor([[0, 2], [1, 2]])
    late = sensor.measure(sensed.others, sensed.headings, sensed.own)
    np.testing.assert_allclose(late, sensor.measure(*seen[-1]), atol=1e-15)


def test_errors_of_gyro_and_encoders_add_up_over_the_delay_and_no_longer() -> None:
    still = [(np.zeros((4000, 2)), np.tile([1.0, 0.0], (4000, 1)))] * 20
    sensed = after(OwnMotion(9, MEASURED, gyro_noise=0.3, encoder_noise=0.2), still).sense(*still[-1])
    assert np.arctan2(*sensed.headings.T[::-1]).std() == pytest.approx(0.3 * PERIOD * 3.0, rel=0.05)
    np.testing.assert_allclose(sensed.own.std(axis=0), 0.2 * PERIOD * 3.0, rtol=0.05)


def test_a_heading_settles_below_the_turning_limit_and_not_above() -> None:
    nid = NearIdentityDiffeomorphism(0.025)
    assert nid.turning_limit(PERIOD) == pytest.approx(2.0 * 0.025 / PERIOD)
    assert nid.turning_limit(0.001, 196) == pytest.approx(np.pi / 2.0 * 0.025 / 0.196, rel=0.01)
    for delay in (0, 1, 4):
        for share, settles in ((0.9, True), (1.1, False)):
            turn = share * nid.turning_limit(PERIOD, delay) * PERIOD / nid.projection_distance
            phi = [0.01] * (delay + 1)
            for _ in range(1500):
                phi.append(phi[-1] - turn * np.sin(phi[-1 - delay]))
            late = max(abs(x) for x in phi[-100:])
            assert bool(late < 1e-3) is settles


def test_behind_a_delay_robots_keep_farther_apart_and_go_more_gently() -> None:
    given = FilterSettings()
    assert delayed_settings(given, 0.0, 0.2) == given
    late = delayed_settings(given, 0.99, 0.2)
    assert late.safe_distance == pytest.approx(0.155 + 0.099)
    assert late.sensing_range == pytest.approx(late.safe_distance + 0.15)
    assert late.gain * 0.99 == pytest.approx(0.5)
    assert delayed_settings(given, 0.033, 0.2).gain == given.gain


def test_unknown_knowledge_is_refused() -> None:
    with pytest.raises(ValueError, match="own motion must be one of"):
        OwnMotion(1, "guess")
