"""The settled motion of robots that hold each command for a period is where the loop, step by step, comes to."""

import numpy as np
import pytest

from formation import random_target
from formation.analysis.cascade import Cascade
from formation.laws.feedforward import shares
from formation.plane import as_complex
from formation.references.curves import ClosedCurve
from formation.references.lag import SAMPLES, Settled, cycle, shape_residual
from formation.references.ramps import Ramps

CURVE = ClosedCurve("figure-eight", (1.0, 0.5), 32.0)
PERIOD = CURVE.period / (SAMPLES / 4)
DELTA = 0.4 - 0.3j
N = 5


@pytest.mark.parametrize("feedforward", [False, True])
def test_held_commands_lag_as_steps_of_the_loop_do(feedforward: bool) -> None:
    """A robot's turn bends each command by half of what its way turns in a period."""
    target, gains = random_target(N, np.random.default_rng(5)), np.array([0.6, 1.0, 1.4])
    t = cycle(CURVE)
    still = Settled(target, CURVE, feedforward, gains)()
    waves = 2j * np.pi * np.fft.fftfreq(SAMPLES, t[1])[:, None]

    def derivative(y: np.ndarray) -> np.ndarray:
        return np.fft.ifft(waves * np.fft.fft(y, axis=0), axis=0)

    way = derivative(still) + CURVE.velocity(t)[:, None] / DELTA
    bend = way * 0.5j * PERIOD * (derivative(way) / way).imag
    extra = np.random.default_rng(2).normal(0.0, 0.01, N) * np.exp(2j * np.pi * t / CURVE.period)[:, None]
    for pushed in (None, extra):
        push = bend + (0.0 if pushed is None else pushed)
        push = push - push[:, :1]
        loop, share = Cascade.of(target, 0.0, gains), shares(target)
        i, j = target.graph.neighbours.T
        y, states = still[0], []
        for step in range(4 * SAMPLES // 4):
            at = 4 * step % SAMPLES
            mu = complex(CURVE.rate(t[at])) if feedforward else 0.0
            u = loop.apply(y) + push[at]
            u[1] += complex(CURVE.factor(t[at])) - y[1] + mu * y[1]
            u[2:] += mu * share * (y[j] - y[i])
            states.append(y)
            y = y + PERIOD * u
        settled = Settled(target, CURVE, feedforward, gains, (DELTA, PERIOD))
        np.testing.assert_allclose(settled(pushed)[::4], states[-SAMPLES // 4 :], atol=2e-4)
        assert np.abs(np.array(states[-SAMPLES // 4 :]) - still[::4]).max() > 2e-3


def test_what_never_repeats_has_no_settled_motion() -> None:
    with pytest.raises(ValueError, match="expected a reference that repeats"):
        cycle(Ramps(np.array([0.0, 1.0]), np.zeros(2, dtype=complex)))
    t = cycle(CURVE)
    assert (len(t), t[0]) == (512, 0.0)
    np.testing.assert_allclose(np.diff(t), 32.0 / 512.0)


def test_the_residual_of_a_shape_is_what_the_best_similarity_leaves_over_its_size() -> None:
    target = random_target(N, np.random.default_rng(5))
    rng = np.random.default_rng(6)
    points = as_complex(rng.normal(size=(3, 2, N, 2)))
    star = as_complex(target.positions)
    columns = np.stack([star, np.ones(N)], axis=1)
    found = shape_residual(target, points)
    assert found.shape == (3, 2)
    for index in np.ndindex(3, 2):
        fit, *_ = np.linalg.lstsq(columns, points[index], rcond=None)
        left = np.linalg.norm(points[index] - columns @ fit)
        size = np.linalg.norm(fit[0] * (star - star.mean()))
        assert found[index] == pytest.approx(left / size)
