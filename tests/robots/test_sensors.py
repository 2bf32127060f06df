"""Relative position sensors."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robots import RelativePositionSensor
from robots.senses.noise import draw_key
from robots.sensors import disturb

EDGES = np.array([[1, 0], [2, 0], [2, 1], [3, 1], [3, 2]])
seeds = st.integers(0, 2**32 - 1)


def state(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-np.pi, np.pi, 4)
    return rng.normal(size=(4, 2)), np.stack([np.cos(theta), np.sin(theta)], axis=-1)


@given(seeds)
def test_a_measurement_is_the_difference_seen_from_the_observers_heading(seed: int) -> None:
    points, headings = state(seed)
    measured = RelativePositionSensor(EDGES).measure(points, headings)
    for (k, i), e in zip(EDGES, measured, strict=True):
        c, s = headings[k]
        np.testing.assert_allclose(e, np.array([[c, s], [-s, c]]) @ (points[i] - points[k]), atol=1e-14)


@given(seeds, st.floats(-np.pi, np.pi), st.floats(-9.0, 9.0))
def test_moving_the_whole_scene_changes_no_measurement(seed: int, turn: float, shift: float) -> None:
    points, headings = state(seed)
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, s], [-s, c]])
    sensor = RelativePositionSensor(EDGES)
    moved = sensor.measure(points @ turned + [shift, -shift], headings @ turned)
    np.testing.assert_allclose(moved, sensor.measure(points, headings), atol=1e-13)


def test_what_an_observer_does_not_sense_cannot_reach_its_measurement() -> None:
    points, headings = state(0)
    sensor = RelativePositionSensor(EDGES)
    whole = sensor.measure(points, headings)
    for row, (k, i) in enumerate(EDGES):
        seen = np.isin(np.arange(4), (k, i))[:, None]
        own = (np.arange(4) == k)[:, None]
        alone = sensor.measure(np.where(seen, points, np.nan), np.where(own, headings, np.nan))
        assert (alone[row] == whole[row]).all()


def test_a_batch_equals_its_single_scenes() -> None:
    scenes = [state(seed) for seed in range(3)]
    points, headings = (np.stack(part) for part in zip(*scenes, strict=True))
    sensor = RelativePositionSensor(EDGES)
    batch = sensor.measure(points, headings)
    for k, scene in enumerate(scenes):
        assert (batch[k] == sensor.measure(*scene)).all()


def test_perfect_sensors_draw_nothing() -> None:
    rng = np.random.default_rng(0)
    assert RelativePositionSensor(EDGES).key(rng) is None
    assert rng.random() == np.random.default_rng(0).random()


def test_noise_has_the_stated_standard_deviations() -> None:
    sensor = RelativePositionSensor(EDGES, position_noise=0.02, bearing_noise=0.1)
    rng = np.random.default_rng(0)
    drawn = [sensor.noise(draw_key(rng)) for _ in range(4000)]
    turns = np.array([np.arctan2(turn[:, 1], turn[:, 0]) for turn, _ in drawn])
    offsets = np.array([offset for _, offset in drawn])
    assert abs(turns.std() / 0.1 - 1.0) < 0.02
    assert abs(offsets.std() / 0.02 - 1.0) < 0.02
    assert abs(turns.mean()) < 0.003
    assert np.abs(offsets.mean(axis=(0, 1))).max() < 0.001


def test_bearing_noise_turns_a_measurement_and_keeps_its_range() -> None:
    sensor = RelativePositionSensor(EDGES, bearing_noise=0.3)
    clean = sensor.measure(*state(1))
    noisy = disturb(clean, sensor.noise(draw_key(np.random.default_rng(0))))
    np.testing.assert_allclose(np.linalg.norm(noisy, axis=1), np.linalg.norm(clean, axis=1))
    assert np.abs(noisy - clean).max() > 0.01


def test_the_same_generator_gives_the_same_noise() -> None:
    sensor = RelativePositionSensor(EDGES, 0.01, 0.01)
    first, second = (sensor.noise(sensor.key(np.random.default_rng(7))) for _ in range(2))
    assert all((a == b).all() for a, b in zip(first, second, strict=True))


@given(
    e=st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
    turn=st.floats(-1.0, 1.0),
    offset=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
)
def test_a_measurement_is_turned_and_then_shifted_by_its_noise(
    e: tuple[float, float], turn: float, offset: tuple[float, float]
) -> None:
    noise = np.array([[np.cos(turn), np.sin(turn)]]), np.array([offset])
    measured = complex(*disturb(np.array([e]), noise)[0])
    assert abs(measured - (complex(*e) * np.exp(1j * turn) + complex(*offset))) < 1e-12
