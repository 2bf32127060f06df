"""Bearings and one ratio with noise: which reading of "a degree and 5 %" gives which figures, by another program."""

import numpy as np
import pytest

from formation import end_configuration
from formation.plane import as_complex
from scenarios.definition.experiment import open_experiment
from scenarios.simulation.loop import simulate
from scenarios.studies.league.noise import FIRST, WITHIN, Reading, readings, rms

PAPER = open_experiment("shape").target


def simulated(reading: Reading, runs: int = 150, steps: int = 1400) -> np.ndarray:
    """(4,) rms distance of followers 3 to 6 from their mean places, metres, of the laws written out by hand."""
    rng = np.random.default_rng(0)
    star = reading.size * np.array([0.5j, -0.5, 0.5, -0.5j, -1.0, 1.0]) * np.sqrt(2.0)
    i, j = np.array([0, 1, 0, 0]), np.array([1, 2, 3, 3])
    w = (star[2:] - star[i]) / (star[j] - star[i])
    a = np.sin(np.angle((star[j] - star[2:]) / (star[i] - star[2:]))) ** 2
    p, seen = np.tile(star, (runs, 1)), []
    for step in range(steps):
        e, f = p[:, i] - p[:, 2:], p[:, j] - p[:, 2:]
        turn = np.exp(1j * np.radians(rng.normal(size=(2, runs, 4))))
        share = 1.0 + 0.05 * rng.normal(size=(2, runs, 4))
        near, far = np.abs(e) * (share[0] if reading.each else 1.0), np.abs(f) * share[1]
        b, c, r = e / np.abs(e) * turn[0], f / np.abs(f) * turn[1], far / near
        paper = a * ((1.0 - w) * near * b + w * far * c)
        ratio = reading.speed * ((1.0 - w) * b + w * r * c) / (1.0 + r)
        p[:, 2:] += 0.033 * (ratio if reading.law == "ratio" else paper)
        if step > steps // 3 and step % 25 == 0:
            seen.append(p[:, 2:].copy())
    return np.sqrt((np.abs(np.stack(seen) - np.mean(seen, axis=(0, 1))) ** 2).mean(axis=(0, 1)))


@pytest.mark.parametrize(
    "reading",
    [
        Reading("ratio", False, 1.0, 1.0),
        Reading("ratio", True, 1.0, 0.5),
        Reading("angle", False, 1.0),
        Reading("angle", True, 1.0),
    ],
)
def test_each_reading_of_the_noise_has_the_covariance_of_a_simulation_by_hand(reading: Reading) -> None:
    np.testing.assert_allclose(rms(PAPER, reading)[2:], simulated(reading), rtol=0.06)


def test_one_reading_alone_gives_the_first_figures_of_both_laws() -> None:
    """5 % of the ratio, a metre between agents 1 and 2, 1 m/s; 5 % of each distance at 0.5 m/s fits the first only."""

    def off(reading: Reading) -> float:
        return float(np.abs(1e3 * rms(PAPER, reading)[2:] / FIRST[reading.law] - 1.0).max())

    all_of_them = readings(np.sqrt(0.5), 1.0)
    assert [each for each in all_of_them if off(each) < WITHIN] == [
        Reading("ratio", False, 1.0, 1.0),
        Reading("angle", False, 1.0),
    ]
    assert WITHIN < off(Reading("ratio", True, 1.0, 0.5)) < 0.1
    assert off(Reading("angle", True, 1.0)) > 0.3


@pytest.mark.slow
def test_on_the_runner_the_ratio_law_has_the_first_figures_at_the_size_and_speed_that_they_need() -> None:
    keys = ("plant.name=single_integrator", "sensor.bearing_noise_deg=1", "sensor.ratio_noise=0.05")
    larger = ("law.parameters={speed=1}", "agents.2.start=[-1.0, 0.5]", "agents.3.start=[-0.6, -0.5]")
    experiment = open_experiment("law-ratio", (*keys, *larger), duration=60.0)
    points = as_complex(simulate(experiment, range(30)).points)[600::25]
    start = experiment.initial_points(0)
    star = as_complex(end_configuration(PAPER, start[0], start[1]))
    found = np.sqrt((np.abs(points - star) ** 2).mean(axis=(0, 1)))[2:]
    np.testing.assert_allclose(1e3 * found, FIRST["ratio"], rtol=0.1)
    spread = np.sqrt((np.abs(points - points.mean(axis=(0, 1))) ** 2).mean(axis=(0, 1)))[2:]
    np.testing.assert_allclose(spread, rms(PAPER, Reading("ratio", False, 1.0, 1.0))[2:], rtol=0.06)
