"""The closest pair: the same as by comparing all pairs, on every kind of crowd, and not quadratic on any."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from numpy.typing import NDArray

from robots.closest_pairs import closest_pairs
from robots.testbed import FEW, separation

Real = NDArray[np.float64]

CROWDS = {
    "random": lambda rng, n: rng.uniform(-1.0, 1.0, (n, 2)),
    "clusters": lambda rng, n: (
        rng.normal(0.0, 0.01, (n, 2)) + rng.uniform(-5.0, 5.0, (n // 10 + 1, 2)).repeat(10, 0)[:n]
    ),
    "a line along y": lambda rng, n: np.stack([np.zeros(n), 0.1 * rng.permutation(n)], axis=-1),
    "a slanted line": lambda rng, n: rng.permutation(n)[:, None] * np.array([1.0, -1.0]),
    "two far columns": lambda rng, n: np.stack([np.arange(n) % 2 * float(n), 0.1 * (np.arange(n) // 2)], axis=-1),
    "a lattice": lambda rng, n: 0.2 * np.stack(np.divmod(rng.permutation(n), max(1, int(n**0.5))), axis=-1),
    "one place": lambda rng, n: np.zeros((n, 2)),
    "few places": lambda rng, n: rng.integers(0, 4, (n, 2)).astype(float),
    "far apart in scale": lambda rng, n: rng.normal(0.0, 1.0, (n, 2)) * 10.0 ** rng.uniform(-12.0, 12.0, (n, 1)),
}


def by_all_pairs(points: Real) -> tuple[Real, NDArray[np.intp]]:
    """(T,) distances and (T, 2) the first pair in the order of rows among the closest."""
    a, b = np.triu_indices(points.shape[1], 1)
    gaps = np.hypot(*np.moveaxis(points[:, a] - points[:, b], -1, 0))
    closest = gaps.argmin(axis=1)
    return gaps.min(axis=1), np.stack([a[closest], b[closest]], axis=1)


def distances(points: Real, pairs: NDArray[np.int64]) -> Real:
    rows = np.arange(len(points))
    return np.hypot(*(points[rows, pairs[:, 0]] - points[rows, pairs[:, 1]]).T)


@pytest.mark.parametrize("n", [2, 3, 40, 200])
@pytest.mark.parametrize("crowd", CROWDS)
def test_the_pair_is_the_one_that_comparing_all_pairs_finds(crowd: str, n: int) -> None:
    rng = np.random.default_rng(n)
    start = np.asarray(CROWDS[crowd](rng, n), dtype=float)
    states = start + np.cumsum(rng.normal(0.0, 0.004, (6, n, 2)), axis=0)
    states[:2] = start  # the crowd itself, ties and all
    found = closest_pairs(states)
    expected, pairs = by_all_pairs(states)
    np.testing.assert_array_max_ulp(distances(states, found), expected, 1)
    assert (found[:2] == pairs[:2]).all()


@given(
    npst.arrays(
        float, st.tuples(st.integers(1, 4), st.integers(2, 9), st.just(2)), elements=st.integers(-3, 3).map(float)
    )
)
def test_of_several_equally_close_pairs_it_is_the_first(states: Real) -> None:
    assert (closest_pairs(states) == by_all_pairs(states)[1]).all()


@given(npst.arrays(float, (1, 6, 2), elements=st.floats(allow_nan=False, min_value=-1e300, max_value=1e300)))
def test_it_is_exact_for_any_finite_points(states: Real) -> None:
    with np.errstate(over="ignore"):
        np.testing.assert_array_max_ulp(distances(states, closest_pairs(states)), by_all_pairs(states)[0], 1)


def test_a_state_that_is_not_finite_names_the_first_pair_without_a_distance() -> None:
    states = np.arange(16.0).reshape(1, 8, 2).repeat(3, axis=0)
    states[1, 3] = np.nan
    states[2, [2, 4]] = np.inf
    assert closest_pairs(states).tolist() == [[0, 1], [0, 3], [2, 4]]


@pytest.mark.parametrize("crowd", CROWDS)
def test_few_robots_are_compared_without_a_compiler_and_have_the_same_pair(crowd: str) -> None:
    rng = np.random.default_rng(1)
    start = np.asarray(CROWDS[crowd](rng, FEW), dtype=float)
    states = start + np.cumsum(rng.normal(0.0, 0.004, (5000, FEW, 2)), axis=0)
    states[:2], states[2, 3], states[3, [2, 4]] = start, np.nan, np.inf
    assert (separation(states).pairs == closest_pairs(states)).all()
