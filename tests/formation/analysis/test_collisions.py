"""The exact collision condition of sequential activation holds, and it is exact."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import TargetFormation, collision_margins, end_configuration, random_target
from formation.analysis.cascade import Cascade
from formation.analysis.collisions import (
    crossed_sight_lines,
    neighbour_clearance,
    others_clearance,
    segment_distance,
    segments_distance,
    settled_within,
)
from formation.plane import as_complex

STARTS = 20_000
SAFE = 0.15


def seen_clearance(target: TargetFormation, start: np.ndarray, end: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """(..., F) nearest that each follower comes to a neighbour while its distance shrinks to these shares of it."""
    k, p, q = target.graph.followers, as_complex(start), as_complex(end)
    way = q[k, None] + (p[..., k] - q[k])[..., None] * shares
    gaps = [np.abs(way - q[m][:, None]).min(axis=-1) for m in target.graph.neighbours.T]
    return np.minimum(*gaps)


def test_of_twenty_thousand_random_starts_none_violates_the_exact_condition_and_c3_admits_less_than_half(
    paper: TargetFormation,
) -> None:
    rng = np.random.default_rng(1)
    end = end_configuration(paper, np.array([0.0, 0.5]), np.array([-0.5, 0.0]))
    start = np.tile(end, (STARTS, 1, 1))
    start[:, 2:] = rng.uniform(-1.5, 1.5, (STARTS, 4, 2))
    clear = neighbour_clearance(paper, start, end)
    shares = np.linspace(1.0, 0.0, 40)
    seen = seen_clearance(paper, start, end, shares)
    assert (seen >= clear - 1e-9).all()
    assert (seen <= clear + np.linalg.norm(start - end, axis=-1)[:, 2:] / 39.0).all(), "and it is no mere bound"
    by_lemma = collision_margins(paper, np.moveaxis(start, 0, -2), end[:, None]).T >= SAFE
    admitted = clear >= SAFE
    assert not (by_lemma & ~admitted).any()
    assert admitted.sum() >= 2 * by_lemma.sum()


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32 - 1))
def test_neighbours_that_are_not_quite_settled_cost_no_more_than_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(5, rng, min_angle=np.radians(25.0))
    end, start = target.positions, target.positions + rng.normal(0.0, 0.5, (5, 2))
    settled = settled_within(target, 0.005)
    bound = neighbour_clearance(target, start, end, settled)
    loop, p = Cascade.of(target), as_complex(end).copy()
    p[:4] += np.concatenate([[0, 0], settled[2:4] * np.exp(2j * np.pi * rng.uniform(size=2))])
    p[4] = as_complex(start)[4]
    for _ in range(1500):
        p[4] += 0.01 * loop.apply(p)[4]
        for m in target.graph.neighbours[2]:
            assert abs(p[4] - p[m]) >= bound[2] - 1e-9


def test_a_neighbour_that_is_off_costs_its_own_distance_and_what_the_follower_makes_of_it(
    paper: TargetFormation,
) -> None:
    settled = np.array([0.0, 0.0, 0.01, 0.0, 0.0, 0.0])
    bound = neighbour_clearance(paper, paper.positions, paper.positions, settled)
    assert bound[1] == pytest.approx(1.0 - 0.01 * (1.0 + np.sqrt(0.5)))


def test_a_settled_agent_is_off_by_its_own_tolerance_and_what_its_neighbours_hand_down(paper: TargetFormation) -> None:
    found = settled_within(paper, 0.005)
    np.testing.assert_allclose(found[:3], [0.0, 0.0, 0.005])
    assert found[3] == pytest.approx(0.005 * (1.0 + np.sqrt(0.5)))


def test_distances_of_segments() -> None:
    assert segment_distance([0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]) == 1.0
    assert segment_distance([3.0, 0.0], [-1.0, 0.0], [1.0, 0.0]) == 2.0
    assert segment_distance([3.0, 4.0], [0.0, 0.0], [0.0, 0.0]) == 5.0
    assert segments_distance([-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]) == 0.0
    assert segments_distance([-1.0, 0.0], [1.0, 0.0], [0.0, 0.5], [0.0, 1.0]) == 0.5


def test_agents_that_are_no_neighbours_and_lines_of_sight_are_looked_at_too(paper: TargetFormation) -> None:
    end = paper.positions
    start = end.copy()
    start[4] = [-1.5, 0.5]  # agent 5 crosses the formation on its way to (1.5, -0.5)
    distance, nearest = others_clearance(paper, start, end)
    assert distance[2] == pytest.approx(0.0, abs=0.5)
    assert nearest[2] in (1, 2)
    crossings = crossed_sight_lines(paper, start, end)
    assert (4, 3, 1) in crossings
    assert all(k == 4 for k, _, _ in crossings)
