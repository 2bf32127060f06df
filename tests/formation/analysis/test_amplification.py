"""How errors grow on their way down a cascade: predicted, and seen."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import expm

from formation import SensingGraph, TargetFormation, random_target, settling_bound
from formation.analysis.amplification import dwell_errors, moving_part, overshoot, peak_gains, transient_gain
from formation.analysis.cascade import Cascade
from formation.analysis.lags import shares
from formation.analysis.noise import bias_response, noise_power, noise_rms
from formation.plane import as_vectors

Strip = Callable[[int], TargetFormation]


@pytest.mark.parametrize(("n", "gain", "noise"), [(6, 1.1, 2.0), (12, 2.2, 5.2), (24, 7.5, 22.7), (48, 161.0, 539.0)])
def test_long_strips_amplify_although_all_their_rates_are_the_same(
    strip: Strip, n: int, gain: float, noise: float
) -> None:
    target = strip(n)
    loop = Cascade.of(target)
    np.testing.assert_allclose(loop.rates[1:], 0.75)
    found, when = transient_gain(loop)
    assert found == pytest.approx(gain, rel=0.03)
    rms = noise_rms(loop, 0.033, noise_power(loop, target.positions, 0.01))
    assert rms[-1] / rms[2] == pytest.approx(noise, rel=0.02)
    worst = np.linalg.svd(loop.exponential(when)[2:, 2:])[2][0].conj()
    step, x, largest = loop.exponential(when / 50.0)[2:, 2:], worst, 1.0
    for _ in range(100):
        x = step @ x
        largest = max(largest, float(np.linalg.norm(x)))
    assert largest == pytest.approx(found, rel=1e-3)


def test_a_strip_of_24_takes_six_times_as_long_as_its_rate_promises(strip: Strip) -> None:
    errors = np.zeros((24, 2))
    errors[2:] = as_vectors(np.exp(1j * np.arange(22)))
    found = settling_bound(strip(24), errors, 1e-3)
    assert found is not None
    assert found > 4.0 * np.log(1e3) / 0.75


def test_in_the_papers_shape_the_norm_needs_a_constant_of_ten(paper: TargetFormation) -> None:
    assert overshoot(Cascade.of(paper), 0.5) == pytest.approx(10.4, abs=0.1)
    assert transient_gain(Cascade.of(paper))[0] == 1.0


def test_two_cascaded_followers_of_one_angle_decay_as_t_times_the_exponential() -> None:

    target = TargetFormation(
        SensingGraph(np.array([[0, 1], [0, 2]])), np.array([[0, 0], [1, 0], [0.0, 1.0], [-1.0, 1.0]])
    )
    loop = Cascade.of(target)
    a, w = loop.rates[1], loop.weights[1]
    assert loop.rates[2] == pytest.approx(a)
    np.testing.assert_allclose(loop.exponential(10.0)[3, 2], a * w * 10.0 * np.exp(-a * 10.0), rtol=1e-9)


def test_the_largest_gain_over_all_frequencies_of_the_papers_shape_is_that_of_what_stands_still(
    paper: TargetFormation,
) -> None:
    loop = Cascade.of(paper)
    measurement, velocity = peak_gains(loop)
    assert (measurement, velocity) == (pytest.approx(3.51, abs=0.01), pytest.approx(3.86, abs=0.01))
    assert measurement == pytest.approx(np.linalg.norm(bias_response(loop), 2))


@pytest.mark.parametrize(("dwell", "expected"), [(1.0, 0.64), (2.0, 0.65), (4.0, 0.52), (8.0, 0.13)])
def test_a_displacement_that_switches_leaves_what_its_dwell_time_says(
    paper: TargetFormation, dwell: float, expected: float
) -> None:
    loop, jump = Cascade.of(paper, 1.0), (0.4 + 0.4j) * (1.0 - 1.0j)
    found = dwell_errors(paper, loop, dwell, jump)
    assert found.max() == pytest.approx(expected, abs=0.006)
    step, y = loop.exponential(dwell), np.zeros(6, dtype=complex)
    for switch in range(200):
        y = step @ (y + (-1) ** switch * shares(paper) * jump)
    np.testing.assert_allclose(np.abs(y), found, atol=1e-9)


@pytest.mark.parametrize(("first_rate", "seed"), [(0.0, 1), (1.0, 3)])
def test_gains_over_frequencies_and_overshoot_are_those_of_a_fine_search(first_rate: float, seed: int) -> None:
    target = random_target(6, np.random.default_rng(seed), np.radians(25.0))
    loop = Cascade.of(target, first_rate)
    first = 1 if first_rate else 2
    matrix = loop.whole[first:, first:]
    by_errors = -(matrix @ bias_response(loop)[first:])
    np.testing.assert_array_equal(moving_part(loop), matrix)
    fastest, eye = loop.rates.max(), np.eye(len(matrix))
    gains = []
    for omega in np.linspace(0.0, 10.0 * fastest, 200):
        inverse = np.linalg.solve(1j * omega * eye - matrix, eye)
        gains.append((np.linalg.norm(inverse @ by_errors, 2), np.linalg.norm(inverse, 2)))
    np.testing.assert_allclose(peak_gains(loop), np.max(gains, axis=0), rtol=0.01)
    rate = 0.5 * float(loop.rates[loop.rates > 0.0].min())
    step, state, sizes = expm(0.02 / fastest * (matrix + rate * eye)), eye, [1.0]
    for _ in range(1500):
        state = step @ state
        sizes.append(float(np.linalg.norm(state, 2)))
    assert overshoot(loop, rate, 30.0 / fastest) == pytest.approx(max(sizes), rel=3e-3)
    plain = [float(np.linalg.norm(expm(t / fastest * matrix), 2)) for t in np.linspace(0.0, 12.0, 121)]
    gain, when = transient_gain(loop)
    assert gain == pytest.approx(max(plain), rel=2e-3)
    assert gain == pytest.approx(np.linalg.norm(expm(when * matrix), 2))


def test_errors_that_have_grown_by_the_horizon_only_count_up_to_it(paper: TargetFormation) -> None:
    """With a rate above the slowest mode's the constant grows without end: by e^{0.1 t} here."""
    loop = Cascade.of(paper)
    early, late = (overshoot(loop, 0.6, horizon) for horizon in (30.0, 40.0))
    assert 1.0 < np.log(late / early) < 1.5
