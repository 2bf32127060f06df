"""What the lanes measure is what the sensors measure, noise and all, and noise is what its words say."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robots.senses import chance
from robots.senses.measure import measure
from robots.senses.noise import Noise, silence
from robots.sensors import RelativePositionSensor, disturb
from robots.worlds.lanes import COS, NOW, PX, SEEN_X, Senses, new_state

Plain = Callable[..., Any]
EDGES = np.array([[1, 0], [2, 0], [2, 1], [3, 1], [3, 2]])
RUNS, N = 2, 4


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize(("position", "bearing"), [(0.0, 0.0), (0.02, 0.0), (0.0, 0.3), (0.02, 0.3)])
def test_lanes_measure_what_sensors_measure(plain: Plain, late: bool, position: float, bearing: float) -> None:
    rng = np.random.default_rng(1)
    state = new_state(rng.uniform(-1.0, 1.0, (RUNS, N, 3)), 0.04)
    state[SEEN_X : SEEN_X + 2] = rng.uniform(-1.0, 1.0, (2, N, RUNS))
    senses = Senses(PX, COS, SEEN_X) if late else NOW
    keys = rng.integers(0, 2**64, RUNS, dtype=np.uint64)
    e = np.full((2, len(EDGES), RUNS), np.nan)
    with np.errstate(over="ignore"):
        plain(measure)(state, EDGES, senses, Noise(keys, position, bearing), e)
    sensor = RelativePositionSensor(EDGES, position, bearing)
    for run in range(RUNS):
        points, headings, others = (
            np.ascontiguousarray(state[field : field + 2, :, run].T) for field in (PX, COS, senses.others)
        )
        relative = sensor.measure(others, headings, points)
        with np.errstate(over="ignore"):
            drawn = np.array([plain(chance.pair)(keys[run], k, i, position, bearing) for k, i in EDGES.tolist()])
        expected = disturb(relative, (drawn[:, :2].copy(), drawn[:, 2:].copy())) if position or bearing else relative
        np.testing.assert_allclose(e[:, :, run].T, expected, atol=1e-12)
    assert silence(3).keys.tolist() == [0, 0, 0]
    assert silence(3)[1:] == (0.0, 0.0)


def test_a_pairs_noise_is_made_of_its_words_by_box_and_muller(plain: Plain) -> None:
    key, position, bearing = np.uint64(0x1234_5678_9ABC_DEF0), 0.3, 0.2
    with np.errstate(over="ignore"):
        words = plain(chance.philox)(*(np.uint64(each) for each in (5, 3, 0, 0)), key)
        found = plain(chance.pair)(key, 5, 3, position, bearing)
        table = plain(chance.pairs)(key, np.array([0, 5]), np.array([1, 3]), position, bearing)
    a, b, c, d = ((float(word) + 0.5) / 2.0**32 for word in words)
    offset = position * np.sqrt(-2.0 * np.log(a)) * np.exp(2j * np.pi * b)
    turn = bearing * np.sqrt(-2.0 * np.log(c)) * np.cos(2.0 * np.pi * d)
    np.testing.assert_allclose(found, [np.cos(turn), np.sin(turn), offset.real, offset.imag])
    np.testing.assert_array_equal(table[1], found)
