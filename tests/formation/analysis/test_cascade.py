"""The cascade is the linear loop that it says it is: matrix, exponential, norm, late rates and a box for the errors."""

from collections.abc import Iterator
from itertools import count, islice
from math import factorial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from formation import TargetFormation, random_target
from formation.analysis import closed_loop
from formation.analysis.cascade import Cascade, exponential
from formation.analysis.closed_loop import arrival, settling_of
from formation.plane import as_complex

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed: int, first_rate: float = 0.7, n: int = 7) -> tuple[Cascade, TargetFormation]:
    """A cascade with own gains, and its target."""
    rng = np.random.default_rng(seed)
    target = random_target(n, rng)
    return Cascade.of(target, first_rate, rng.uniform(0.5, 2.0, n - 2)), target


def matrix_of(loop: Cascade) -> np.ndarray:
    """The matrix of all agents, row by row from eq. (pk)."""
    matrix = np.zeros((loop.n, loop.n), dtype=complex)
    matrix[1, 1] = -loop.rates[0]
    for k, (i, j) in enumerate(loop.graph.neighbours.tolist(), start=2):
        rate, w = loop.rates[k - 1], loop.weights[k - 2]
        matrix[k, k] = -rate
        matrix[k, i] = rate * (1.0 - w)
        matrix[k, j] = rate * w
    return matrix


@given(seed=SEEDS)
def test_each_agent_relaxes_to_the_mean_of_its_neighbours_for_any_number_of_states_at_once(seed: int) -> None:
    loop, target = drawn(seed)
    matrix, rng = matrix_of(loop), np.random.default_rng(seed)
    scale = np.abs(matrix).max()
    np.testing.assert_allclose(loop.whole, matrix, atol=1e-14 * scale)
    np.testing.assert_allclose(loop.matrix, matrix[1:, 1:], atol=1e-14 * scale)
    np.testing.assert_allclose(loop.rows.toarray(), matrix, atol=1e-14 * scale)
    for shape in ((7,), (7, 3), (7, 2, 3)):
        states = as_complex(rng.normal(size=(*shape, 2)))
        expected = np.tensordot(matrix, states, axes=1)
        np.testing.assert_allclose(loop.apply(states), expected, atol=1e-13 * scale)
    p = as_complex(target.positions)
    for (i, j), k, w in zip(loop.graph.neighbours, loop.graph.followers, loop.weights, strict=True):
        assert (1.0 - w) * p[i] + w * p[j] == pytest.approx(p[k])


@pytest.mark.parametrize("first_rate", [0.0, 0.7, 500.0])
@given(seed=SEEDS)
def test_the_norm_is_the_largest_sum_of_absolute_values_in_a_row(first_rate: float, seed: int) -> None:
    loop, _ = drawn(seed, first_rate)
    assert loop.norm == pytest.approx(np.abs(matrix_of(loop)).sum(axis=1).max())


@settings(max_examples=15)
@given(seed=SEEDS, duration=st.floats(0.01, 12.0))
def test_states_are_carried_on_by_the_exponential_whether_it_is_made_or_not(seed: int, duration: float) -> None:
    loop, _ = drawn(seed)
    exact = expm(matrix_of(loop) * duration)
    atol = 1e-11 * np.abs(exact).max()
    np.testing.assert_allclose(loop.exponential(duration), exact, atol=atol)
    for shape in ((7,), (7, 2), (7, 2, 2)):
        states = as_complex(np.random.default_rng(seed).normal(size=(*shape, 2)))
        np.testing.assert_allclose(loop.act(states, duration), np.tensordot(exact, states, axes=1), atol=10.0 * atol)


def test_nothing_happens_in_no_time() -> None:
    loop, _ = drawn(1)
    np.testing.assert_array_equal(loop.exponential(0.0), np.eye(7))
    np.testing.assert_array_equal(exponential(lambda x: 0.0 * x, 3, 0.0), np.eye(3))


@pytest.mark.parametrize("norm", [0.5, 1.0])
def test_the_series_ends_where_its_remainder_is_below_a_trillionth_of_rounding(norm: float) -> None:
    """Of a shift by one place the last entry is a single term of the series, the seventeenth."""
    shift = norm * np.eye(18, k=1)
    found = exponential(lambda x: shift @ x, 18, norm)
    assert found[0, 16] == pytest.approx(norm**16 / factorial(16), rel=1e-3, abs=0.0)
    assert abs(found[0, 17] - norm**17 / factorial(17)) < 1e-19


@given(seed=SEEDS, first_rate=st.sampled_from([0.0, 0.05, 0.7]))
def test_the_late_rate_is_the_slowest_among_an_agent_and_all_that_it_hangs_on(seed: int, first_rate: float) -> None:
    loop, _ = drawn(seed, first_rate)
    hangs: list[set[int]] = [set(), {1}]
    for k, (i, j) in enumerate(loop.graph.neighbours.tolist(), start=2):
        hangs.append({k} | hangs[i] | hangs[j])
    own = np.concatenate([[np.inf], loop.rates])
    own[own == 0.0] = np.inf
    assert loop.late_rates.tolist() == [min(own[list(on)]) for on in hangs[1:]]


@settings(max_examples=20)
@given(seed=SEEDS)
def test_errors_never_leave_their_box_and_no_smaller_box_is_known_to_hold(seed: int) -> None:
    loop, _ = drawn(seed)
    reach, pulls = loop.reach, np.abs(loop.pulls)
    assert reach[:2].tolist() == [0.0, 1.0]
    i, j = loop.graph.neighbours.T
    np.testing.assert_allclose(reach[2:], np.maximum(1.0, pulls[:, 0] * reach[i] + pulls[:, 1] * reach[j]))
    errors = as_complex(np.random.default_rng(seed).normal(size=(7, 2)))
    errors[0] = 0.0
    size, step = (np.abs(errors[1:]) / reach[1:]).max(), loop.exponential(0.3)
    for _ in range(20):
        errors = step @ errors
        assert (np.abs(errors[1:]) <= size * reach[1:] + 1e-12).all()


@settings(max_examples=20)
@given(seed=SEEDS, bound=st.floats(0.01, 2.0))
def test_many_agents_settle_when_few_do_though_no_full_matrix_is_made(seed: int, bound: float) -> None:
    loop, _ = drawn(seed)
    errors = np.random.default_rng(seed).normal(size=(7, 2))
    errors[0] = 0.0
    by_matrix = settling_of(loop, errors, bound, 0.1, 60.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(closed_loop, "DENSE", 6)
        assert settling_of(loop, errors, bound, 0.1, 60.0) == by_matrix
    steps = np.array([as_complex(errors)] * 601)
    step = expm(matrix_of(loop) * 0.1)
    for k in range(600):
        steps[k + 1] = step @ steps[k]
    above = np.flatnonzero(np.abs(steps).max(axis=1) >= bound)
    expected = None if above.size and above[-1] == 600 else 0.1 * (above[-1] + 1 if above.size else 0)
    assert by_matrix == (None if expected is None else pytest.approx(expected))


def test_nobody_looks_further_once_the_errors_are_in_a_box_that_they_never_leave() -> None:
    taken: list[float] = []

    def sizes() -> object:
        for size in (3.0, 0.9, 0.55, 0.45, 0.4, 5.0):
            taken.append(size)
            yield np.array([0.0, size, 0.1])

    assert arrival(sizes(), np.array([0.0, 1.0, 2.0]), 1.0, 0.1) == pytest.approx(0.1)  # type: ignore[arg-type]
    assert taken == [3.0, 0.9, 0.55, 0.45]


@pytest.mark.parametrize(("horizon", "expected"), [(0.5, 0.3), (0.3, 0.3), (0.2, None)])
def test_who_has_not_arrived_at_the_horizon_has_no_time_of_arrival(horizon: float, expected: float | None) -> None:
    sizes = islice((np.array([0.0, size]) for size in (3.0, 2.0, 1.0, 0.99, 0.98, 0.97)), 6)
    found = arrival(sizes, np.array([0.0, 100.0]), 1.0, 0.1, horizon)
    assert found == (None if expected is None else pytest.approx(expected))


def test_arrival_is_told_to_a_twentieth_of_a_second_and_looked_for_over_ten_minutes() -> None:
    def until(last: int) -> Iterator[np.ndarray]:
        for k in count():
            yield np.array([0.0, 2.0 if k <= last else 0.5])

    reach = np.array([0.0, 10.0])
    assert arrival(until(7_999), reach, 1.0) == pytest.approx(400.0)
    assert arrival(until(11_999), reach, 1.0) == pytest.approx(600.0)
    assert arrival(until(12_000), reach, 1.0) is None
    slow, _ = drawn(1)
    slow = Cascade(slow.graph, slow.weights, np.full(6, 0.01))
    errors = np.zeros((7, 2))
    errors[1] = 1.0
    assert settling_of(slow, errors, 0.02) == settling_of(slow, errors, 0.02, 0.05, 600.0)
    assert settling_of(slow, errors, 1e-4) is None
