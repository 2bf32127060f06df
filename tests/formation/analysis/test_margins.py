"""The margins of delay and of the control period, against loops that are run beside them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation.analysis.margins import delay_margin, longest_period, most_periods


def growth(mode: complex, delay: float, h: float = 2e-3) -> float:
    """By how much |x| grows over the second half of a long Euler run of dx/dt = mode x(t - delay)."""
    lag = round(delay / h)
    x = [1.0 + 0j] * (lag + 1)
    for _ in range(round(60.0 / h)):
        x.append(x[-1] + h * mode * x[-1 - lag])
    sizes = np.abs(x[lag:])
    quarter = len(sizes) // 4
    return float(sizes[-quarter:].max() / sizes[quarter : 2 * quarter].max())


@pytest.mark.parametrize("mode", [-1.0 + 0j, -0.5 + 0.5j, -0.3 - 1.0j])
def test_a_delayed_mode_decays_below_its_margin_and_grows_above(mode: complex) -> None:
    margin = delay_margin([mode])
    assert growth(mode, 0.95 * margin) < 1.0 < growth(mode, 1.05 * margin)


@given(rate=st.floats(0.1, 5.0), turn=st.floats(-1.4, 1.4), delay=st.integers(0, 8))
def test_held_commands_of_old_measurements_decay_below_the_longest_period_and_grow_above(
    rate: float, turn: float, delay: int
) -> None:
    mode = -rate * np.exp(1j * turn)
    longest = longest_period([mode], delay)

    def radius(period: float) -> float:
        polynomial = np.zeros(delay + 2, dtype=np.complex128)
        polynomial[0], polynomial[1] = 1.0, -1.0
        polynomial[-1] -= period * mode
        return float(np.abs(np.roots(polynomial)).max())

    assert radius(0.99 * longest) < 1.0 < radius(1.01 * longest)


@given(rate=st.floats(0.1, 5.0), turn=st.floats(-1.4, 1.4), period=st.floats(0.01, 0.3))
def test_the_most_periods_of_delay_are_stable_and_one_more_is_not(rate: float, turn: float, period: float) -> None:
    mode = -rate * np.exp(1j * turn)
    most = most_periods([mode], period)
    assert most is not None
    if most >= 0:
        assert longest_period([mode], most) > period
    assert longest_period([mode], most + 1) <= period * (1.0 + 1e-9)


def test_the_papers_rates_stand_a_delay_of_half_pi_seconds_and_these_periods() -> None:
    modes = [-1.0, -0.5, -0.64]
    assert delay_margin(modes) == pytest.approx(np.pi / 2.0)
    found = [longest_period(modes, d) for d in (0, 1, 2, 5)]
    np.testing.assert_allclose(found, [2.0, 1.0, 0.618, 0.2846], atol=1e-3)
    assert most_periods(modes, 0.033) == 47


def test_nothing_that_moves_stands_any_delay_and_what_grows_stands_none() -> None:
    assert delay_margin([]) == longest_period([]) == np.inf
    assert most_periods([], 0.1) is None
    assert delay_margin([0.2]) == longest_period([0.2]) == 0.0
    assert most_periods([0.2], 0.1) == -1


@given(rate=st.floats(0.1, 5.0), turn=st.floats(-1.4, 1.4), period=st.floats(0.3, 20.0))
def test_where_the_period_is_too_long_for_a_mode_not_even_no_delay_is_stable(
    rate: float, turn: float, period: float
) -> None:
    mode = -rate * np.exp(1j * turn)
    most = most_periods([mode, -0.01], period)
    assert (most == -1) == (longest_period([mode]) <= period)


def test_of_several_modes_the_tightest_decides() -> None:
    modes = [-1.0, -0.5 + 0.4j, -2.0]
    assert delay_margin(modes) == min(delay_margin([mode]) for mode in modes)
    assert longest_period(modes, 3) == min(longest_period([mode], 3) for mode in modes)
    assert most_periods(modes, 0.05) == min(most_periods([mode], 0.05) or 0 for mode in modes)
