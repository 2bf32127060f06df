"""Coverage of the identified intervals over synthetic logs, printed; ``EVIDENCE_LOGS=1000`` for all of it."""

import os

import numpy as np
import pytest

from robots.identification.check import checked
from robots.identification.estimate import identify
from robots.identification.numbers import NAMES
from robots.identification.synthetic import random_truth, random_way, synthesise

LOGS = int(os.environ.get("EVIDENCE_LOGS", "25"))


def coverage(logs: int) -> dict[str, tuple[int, float, float]]:
    """Per number: in how many logs the interval holds the truth, mean error and median full width."""
    held, errors, widths = (np.empty((logs, len(NAMES))) for _ in range(3))
    for seed in range(logs):
        rng = np.random.default_rng(seed)
        truth = random_truth(rng)
        way = random_way(rng, int(rng.integers(500, 5001)))
        found = identify(checked(*synthesise(way, truth, rng))).intervals
        for i, name in enumerate(NAMES):
            interval, value = found[name], getattr(truth, name)
            held[seed, i], errors[seed, i] = interval.holds(value), interval.value - value
            widths[seed, i] = interval.high - interval.low
    return {
        name: (int(held[:, i].sum()), float(errors[:, i].mean()), float(np.median(widths[:, i])))
        for i, name in enumerate(NAMES)
    }


@pytest.mark.slow
def test_intervals_hold_the_truth_in_95_of_100_logs() -> None:
    found = coverage(LOGS)
    print(f"{LOGS} synthetic logs of 500 to 5000 turns")
    for name, (held, error, width) in found.items():
        print(f"  {name:16} held in {held:4d}, mean error {error / width:+.3f} of the median width {width:.3g}")
    chance = 3.0 * np.sqrt(0.95 * 0.05 / LOGS)
    for name, (held, error, width) in found.items():
        assert abs(held / LOGS - 0.95) < max(0.02, chance), name
        assert abs(error) < max(0.1, 1.0 / np.sqrt(LOGS)) * width, name
