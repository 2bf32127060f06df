"""The parts of the search for the closest pair, each by itself: sorting, sweeping, the grid, equal points."""

from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots import closest_pairs as search

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=12)
Plain = Callable[..., Any]


def first_closest(p: np.ndarray) -> tuple[float, int, int]:
    return min((float(np.hypot(*(p[i] - p[j]))), i, j) for i, j in combinations(range(len(p)), 2))


@EXAMPLES
@given(seed=SEEDS, n=st.integers(1, 60), axis=st.integers(0, 1), grain=st.sampled_from([0.3, 1e-9]))
def test_points_are_sorted_along_one_axis_then_the_other_then_by_row(
    plain: Plain, seed: int, n: int, axis: int, grain: float
) -> None:
    rng = np.random.default_rng(seed)
    p = np.round(rng.normal(size=(n, 2)) / grain) * grain
    expected = np.lexsort((np.arange(n), p[:, 1 - axis], p[:, axis])).tolist()
    order = rng.permutation(n)
    plain(search._shell_sort)(p, axis, order)
    assert order.tolist() == expected
    order = rng.permutation(n)
    plain(search._sort)(p, axis, order, np.full(n + 1, -7))
    assert sorted(order.tolist()) == list(range(n))
    np.testing.assert_array_equal(p[order, axis], np.sort(p[:, axis]))


@pytest.mark.parametrize(("moved", "done"), [(0, True), (4, True), (5, False)])
def test_insertion_gives_up_after_four_shifts_a_point(plain: Plain, moved: int, done: bool) -> None:
    """One of 40 points from the front to the back costs 39 shifts; four of them 4 times 39, five more than 160."""
    p = np.arange(40.0)[:, None] * [1.0, 0.0]
    order = np.roll(np.arange(40), -moved)
    assert plain(search._insertion)(p, 0, order) == done
    assert sorted(order.tolist()) == list(range(40))
    if done:
        assert order.tolist() == list(range(40))


@EXAMPLES
@given(seed=SEEDS, n=st.integers(2, 50), axis=st.integers(0, 1), size=st.sampled_from([1e-3, 1.0, 1e3]))
def test_a_sweep_and_a_grid_find_the_first_closest_pair_whatever_the_scale(
    plain: Plain, seed: int, n: int, axis: int, size: float
) -> None:
    rng = np.random.default_rng(seed)
    for p in (rng.normal(size=(n, 2)) * size, rng.integers(0, 9, (n, 2)) * size):
        expected = first_closest(p)
        start = plain(search._apart)(p, n - 1, 0)
        assert start == (float(np.hypot(*(p[0] - p[-1]))), 0, n - 1)
        order = np.argsort(p[:, axis], kind="stable")
        best, whole = plain(search._sweep)(p, order, axis, start)
        if whole:
            assert best == pytest.approx(expected, rel=1e-15)
        if start[0] > 0.0:
            first, after = np.empty(128, dtype=int), np.empty(n, dtype=int)
            assert plain(search._grid)(p, rng.permutation(n), start, first, after) == pytest.approx(expected, rel=1e-15)


def test_a_sweep_gives_way_after_sixteen_comparisons_a_point(plain: Plain) -> None:
    p = np.stack([np.zeros(60), np.arange(60.0)], axis=1)
    far = (1e3, 0, 59)
    for n, whole in ((33, True), (35, False)):  # n (n - 1) / 2 comparisons, 16 n allowed
        assert plain(search._sweep)(p[:n] * 1e4, np.arange(n), 0, far)[1] is whole


@EXAMPLES
@given(seed=SEEDS, n=st.integers(2, 40))
def test_of_equal_points_the_first_pair_in_the_order_of_rows_is_found(plain: Plain, seed: int, n: int) -> None:
    p = np.random.default_rng(seed).integers(0, 4, (n, 2)).astype(float)
    pairs = [(0.0, i, j) for i, j in combinations(range(n), 2) if (p[i] == p[j]).all()]
    assert plain(search._coincident)(p, np.empty(n, dtype=int)) == min(pairs, default=(0.0, n, n))


def test_how_far_points_reach_and_spread_and_which_pair_is_closer(plain: Plain) -> None:
    p = np.array([[1.0, -5.0], [-3.0, 2.0], [0.5, 4.0]])
    assert plain(search._reach)(p) == 5.0
    assert [plain(search._spread)(p, axis) for axis in (0, 1)] == [4.0, 9.0]
    assert plain(search._spread)(np.array([[0.0, 0.0], [np.nan, 0.0]]), 0) == np.inf
    closer = plain(search._closer)
    assert closer((1.0, 5, 6), (2.0, 0, 1))
    assert not closer((2.0, 0, 1), (1.0, 5, 6))
    assert [closer((1.0, *pair), (1.0, 1, 4)) for pair in ((1, 3), (0, 9), (1, 4), (1, 5), (2, 3))] == [
        True, True, False, False, False,
    ]  # fmt: skip
    assert plain(search._all_pairs)(p) == first_closest(p)
    with np.errstate(invalid="ignore"):
        nowhere = plain(search._all_pairs)(np.array([[0.0, 0.0], [1.0, 0.0], [np.inf, 0.0], [np.inf, 1.0]]))
    assert nowhere[1:] == (2, 3)


@given(cx=st.integers(-(2**40), 2**40), cy=st.integers(-(2**40), 2**40))
def test_a_cell_has_a_bucket_of_the_table(plain: Plain, cx: int, cy: int) -> None:
    bucket = plain(search._bucket)
    with np.errstate(over="ignore"):
        found = {bucket(cx + dx, cy + dy, 64) for dx in range(4) for dy in range(4)}
    assert all(0 <= each < 64 for each in found)
    assert len(found) > 4
