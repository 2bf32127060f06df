"""Numbers by chance that follow from a key and a place: the published function, normal, and independent."""

from __future__ import annotations

import numpy as np
import pytest

from robots.compiled import compiled
from robots.senses.chance import pairs, philox
from robots.senses.noise import draw_key


@compiled
def words(counter: np.ndarray, key: np.uint64, out: np.ndarray) -> None:
    out[0], out[1], out[2], out[3] = philox(counter[0], counter[1], counter[2], counter[3], key)


@pytest.mark.parametrize(
    ("counter", "key", "expected"),
    [
        ([0, 0, 0, 0], 0, [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]),
        ([0xFFFFFFFF] * 4, 0xFFFFFFFFFFFFFFFF, [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]),
        (
            [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344],
            0x299F31D0A4093822,
            [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
        ),
    ],
)
def test_it_is_philox_by_the_answers_that_come_with_random123(
    counter: list[int], key: int, expected: list[int]
) -> None:
    out = np.zeros(4, dtype=np.uint64)
    words(np.array(counter, dtype=np.uint64), np.uint64(key), out)
    assert out.tolist() == expected


def test_noise_of_all_pairs_and_periods_is_normal_and_of_nothing_else_s_making() -> None:
    rng, n = np.random.default_rng(0), 100
    observers, observed = np.divmod(np.arange(n * n), n)
    drawn = np.stack([pairs(draw_key(rng), observers, observed, 0.02, 0.1) for _ in range(20)])
    turns, offsets = np.arctan2(drawn[..., 1], drawn[..., 0]) / 0.1, drawn[..., 2:] / 0.02
    numbers = np.concatenate([turns[..., None], offsets], axis=-1)  # (20, n^2, 3)
    flat = numbers.reshape(-1, 3)
    assert np.abs(flat.mean(axis=0)).max() < 4.0 / np.sqrt(len(flat))
    np.testing.assert_allclose(flat.std(axis=0), 1.0, rtol=4.0 / np.sqrt(2.0 * len(flat)))
    np.testing.assert_allclose((flat**4).mean(axis=0), 3.0, rtol=0.05)
    assert np.abs(np.corrcoef(flat.T) - np.eye(3)).max() < 4.0 / np.sqrt(len(flat))
    table = numbers.reshape(20, n, n, 3)
    for axis in (0, 1, 2):
        moved = np.roll(table, 1, axis=axis)
        assert abs((table * moved).mean()) < 4.0 / np.sqrt(table.size)
    assert abs((table * table.swapaxes(1, 2))[:, ~np.eye(n, dtype=bool)].mean()) < 4.0 / np.sqrt(table.size / 2)


def test_a_pair_has_the_same_noise_whoever_else_is_measured() -> None:
    key = np.uint64(123456789)
    alone = pairs(key, np.array([3]), np.array([1]), 0.1, 0.2)
    among = pairs(key, np.array([0, 3, 5]), np.array([2, 1, 1]), 0.1, 0.2)
    assert (alone[0] == among[1]).all()
