"""Who is near whom, and who hangs on whom: the parts of the filters that look for neighbours and for groups."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots.safety import crowd, things
from robots.safety.joint import Rows, groups, nearest
from robots.safety.joint import things as codes_of_things

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=20)
Plain = Callable[..., Any]


@EXAMPLES
@given(seed=SEEDS, n=st.integers(1, 40), side=st.sampled_from([0.3, 2.0]), far=st.booleans())
def test_nine_cells_hold_everybody_within_a_side_and_nobody_twice(
    plain: Plain, seed: int, n: int, side: float, far: bool
) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1.5, 1.5, (2, n)) * (1e12 if far else 1.0)
    lost = rng.random(n) < 0.1
    x[lost] = np.nan
    size = 1
    while size < 2 * n:
        size *= 2
    cells, order, first = np.empty((n, 3), np.int64), np.empty(n, np.int64), np.empty(size + 1, np.int64)
    plain(crowd.fill_grid)(x, y, side, cells, first, order)
    assert (cells[lost, 2] == -1).all()
    assert sorted(order[: first[-1]].tolist()) == np.flatnonzero(~lost).tolist()
    for b in range(size):
        inside = order[first[b] : first[b + 1]].tolist()
        assert inside == sorted(inside)
        assert all(cells[i, 2] == b for i in inside)
    found = np.empty(n, np.int64)
    for i in range(n):
        count = plain(crowd.around)(x[i], y[i], side, i, cells, first, order, found)
        plain(crowd.in_rows)(found, count)
        near = found[:count].tolist()
        assert near == sorted(set(near))
        assert i not in near
        gaps = np.hypot(x - x[i], y - y[i])
        wanted = set(np.flatnonzero(gaps < side).tolist()) - {i}
        assert set(near) >= (set() if lost[i] else wanted)
        if not far:
            assert (np.abs(np.stack([x[near] - x[i], y[near] - y[i]])) <= 2.0 * side).all()
        if lost[i]:
            assert count == 0


def test_all_others_of_a_small_crowd_are_found_in_their_order(plain: Plain) -> None:
    found = np.full(5, -7)
    assert plain(crowd.others)(2, 5, found) == 4
    assert found.tolist() == [0, 1, 3, 4, -7]


@EXAMPLES
@given(seed=SEEDS, kind=st.integers(1, 5))
def test_the_nearest_point_of_a_core_is_where_the_unit_vector_comes_from(plain: Plain, seed: int, kind: int) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(-np.pi, np.pi, kind))
    vertices = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for p in rng.uniform(-2.0, 2.0, (20, 2)):
        distance, nx, ny = plain(things.nearest_on_obstacle)(vertices, *p.tolist())
        after = np.roll(vertices, -1, axis=0)
        border = (np.linspace(0.0, 1.0, 501)[:, None, None] * (after - vertices) + vertices).reshape(-1, 2)
        least = np.linalg.norm(border - p, axis=1).min()
        e, q = after - vertices, p - vertices
        inside = kind > 2 and (e[:, 0] * q[:, 1] - e[:, 1] * q[:, 0] > 0.0).all()
        assert distance == pytest.approx(-least if inside else least, abs=1e-3)
        assert np.hypot(nx, ny) == pytest.approx(1.0)
        touched = p - distance * np.array([nx, ny])
        assert np.linalg.norm(border - touched, axis=1).min() < 3e-3
    assert plain(things.nearest_on_obstacle)(vertices[:1], *vertices[0].tolist())[0] == 0.0


def drawn_rows(seed: int, n: int = 7, m: int = 9) -> Rows:
    rng = np.random.default_rng(seed)
    first, second = rng.integers(0, n, m), rng.integers(0, n, m)
    second[(second == first) | (rng.random(m) < 0.3)] = -1
    return Rows(first, second, rng.integers(0, 20, m), rng.normal(size=(m, 2)), rng.normal(size=m))


@EXAMPLES
@given(seed=SEEDS)
def test_rows_are_of_differences_of_velocities(seed: int) -> None:
    rows, rng = drawn_rows(seed), np.random.default_rng(seed)
    v, lowered, speed = rng.normal(size=(7, 2)), rng.uniform(0.0, 1.0, 7), rng.uniform(0.0, 2.0, 7)
    matrix, slack, reach = rows.matrix(7), rows.slack(v, lowered), rows.within_reach(speed)
    for row, (i, j) in enumerate(zip(rows.first.tolist(), rows.second.tolist(), strict=True)):
        relative = v[i] - (v[j] if j >= 0 else 0.0)
        assert matrix[row] @ v.ravel() == pytest.approx(rows.a[row] @ relative)
        allowance = lowered[i] if j < 0 else min(lowered[i], lowered[j])
        assert slack[row] == pytest.approx(rows.a[row] @ relative - rows.lower[row] + allowance)
        together = speed[i] + (speed[j] if j >= 0 else 0.0)
        assert reach[row] == (rows.lower[row] > -together * np.linalg.norm(rows.a[row]))
    some = rows.where(np.arange(9) % 2 == 0)
    assert some.codes.tolist() == rows.codes[::2].tolist()
    np.testing.assert_array_equal(some.matrix(7), matrix[::2])


@EXAMPLES
@given(seed=SEEDS)
def test_groups_are_those_that_rows_connect(seed: int) -> None:
    rows = drawn_rows(seed)
    linked = np.eye(7, dtype=int)
    for i, j in zip(rows.first, rows.second, strict=True):
        if j >= 0:
            linked[i, j] = linked[j, i] = 1
    together = np.linalg.matrix_power(linked, 7) > 0
    expected = sorted({tuple(np.flatnonzero(row).tolist()) for row in together})
    assert [tuple(group.tolist()) for group in groups(7, rows)] == expected


def test_a_problem_without_solution_is_relaxed_by_the_least_that_helps_and_its_limits_are_kept() -> None:
    wish, hard = np.array([[0.0, 0.0]]), np.eye(2)
    x, relaxed = nearest(wish, np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.3, 0.1]), hard, 1.0)
    assert relaxed == pytest.approx(0.2, abs=1e-6)
    np.testing.assert_allclose(x, [[0.1, 0.0]], atol=1e-5)
    x, relaxed = nearest(wish, np.array([[1.0, 0.0]]), np.array([1.5]), hard, 1.0)
    assert relaxed == pytest.approx(0.5, abs=1e-6)
    np.testing.assert_allclose(x, [[1.0, 0.0]], atol=1e-5)
    x, relaxed = nearest(np.array([[2.0, 0.3]]), np.array([[0.0, 1.0]]), np.array([0.4]), hard, 1.0)
    assert relaxed == 0.0
    np.testing.assert_allclose(x, [[1.0, 0.4]], atol=1e-9)


def test_walls_have_the_four_numbers_after_the_robots_and_obstacles_those_after() -> None:
    assert codes_of_things(5, 4, 2).tolist() == [5, 6, 7, 8, 9, 10]
    assert codes_of_things(5, 0, 2).tolist() == [9, 10]
