"""Distances between ways and lines of sight that are crossed, against the same looked up point by point."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import random_target
from formation.analysis.cascade import Cascade
from formation.analysis.collisions import (
    crossed_sight_lines,
    neighbour_clearance,
    others_clearance,
    segment_distance,
    segments_distance,
    settled_within,
)

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=20)
SHARES = np.linspace(0.0, 1.0, 101)


def along(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(101, 2) points of a segment."""
    return a + SHARES[:, None] * (b - a)


def gap(one: np.ndarray, other: np.ndarray) -> float:
    """The least distance of two clouds of points."""
    return float(np.linalg.norm(one[:, None] - other[None], axis=-1).min())


@EXAMPLES
@given(seed=SEEDS)
def test_a_point_is_as_far_from_a_segment_as_from_its_nearest_point(seed: int) -> None:
    p, a, b = np.random.default_rng(seed).normal(size=(3, 2, 4, 2))
    found = segment_distance(p, a, b)
    assert found.shape == (2, 4)
    for index in np.ndindex(2, 4):
        nearest = gap(p[index][None], along(a[index], b[index]))
        assert nearest - 0.03 <= found[index] <= nearest + 1e-12
    np.testing.assert_allclose(segment_distance(p, a, a), np.linalg.norm(p - a, axis=-1))


@EXAMPLES
@given(seed=SEEDS)
def test_two_segments_are_as_far_apart_as_their_nearest_points_and_not_at_all_where_they_cross(seed: int) -> None:
    a, b, c, d = np.random.default_rng(seed).normal(size=(4, 10, 2))
    found = segments_distance(a, b, c, d)
    for index in range(10):
        nearest = gap(along(a[index], b[index]), along(c[index], d[index]))
        assert nearest - 0.06 <= found[index] <= nearest + 1e-12
        side = np.linalg.solve(np.stack([b[index] - a[index], c[index] - d[index]], axis=1), c[index] - a[index])
        assert (found[index] == 0.0) == bool(((side > 0.0) & (side < 1.0)).all())


@EXAMPLES
@given(seed=SEEDS, loose=st.booleans())
def test_clearances_are_those_of_the_segments_and_of_what_settling_leaves(seed: int, loose: bool) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    start, end = rng.normal(size=(2, 6, 2))
    settled = rng.uniform(0.0, 0.1, 6) if loose else None
    near = neighbour_clearance(target, start, end, settled)
    both = neighbour_clearance(target, np.stack([start, end]), np.stack([end, start]), settled)
    np.testing.assert_allclose(both[0], near)
    others, who = others_clearance(target, start, end)
    pulls = np.abs(Cascade.of(target).pulls)
    edges = {tuple(edge) for edge in target.graph.edges.tolist()}
    for row, (i, j) in enumerate(target.graph.neighbours.tolist()):
        k = row + 2
        away = [float(segment_distance(end[m], start[k], end[k])) for m in (i, j)]
        if settled is not None:
            wander = pulls[row, 0] * settled[i] + pulls[row, 1] * settled[j]
            away = [distance - wander - settled[m] for distance, m in zip(away, (i, j), strict=True)]
        assert near[row] == pytest.approx(min(away))
        strangers = [m for m in range(6) if m != k and (k, m) not in edges and (m, k) not in edges]
        ways = [float(segments_distance(start[k], end[k], start[m], end[m])) for m in strangers]
        assert others[row] == (pytest.approx(min(ways)) if ways else np.inf)
        assert who[row] == (strangers[int(np.argmin(ways))] if ways else -1)


@EXAMPLES
@given(seed=SEEDS)
def test_a_line_of_sight_is_crossed_by_who_rests_in_the_triangle_that_it_sweeps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    start, end = rng.normal(size=(2, 6, 2))
    expected = []
    for k, pair in zip(range(2, 6), target.graph.neighbours.tolist(), strict=True):
        for i in pair:
            for m in set(range(6)) - {k, i}:
                place = end[m] if m < k else start[m]
                corners = np.vstack([np.stack([end[i], start[k], end[k]]).T, np.ones(3)])
                if (np.linalg.solve(corners, [*place, 1.0]) > 0.0).all():
                    expected.append((k, i, m))
    assert sorted(crossed_sight_lines(target, start, end)) == sorted(expected)


@given(seed=SEEDS, tolerance=st.floats(1e-3, 0.1))
def test_a_settled_agent_is_off_by_the_tolerance_and_by_what_its_neighbours_are_off(
    seed: int, tolerance: float
) -> None:
    target = random_target(7, np.random.default_rng(seed))
    found, pulls = settled_within(target, tolerance), np.abs(Cascade.of(target).pulls)
    i, j = target.graph.neighbours.T
    assert not found[:2].any()
    np.testing.assert_allclose(found[2:], tolerance + pulls[:, 0] * found[i] + pulls[:, 1] * found[j])
