"""The two laws that go beyond the paper: no distances, and whichever neighbours are seen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import LAWS, AngleLaw, decay_rates, random_target
from formation.analysis.prediction import end_configuration
from formation.audit import Subject
from formation.framework import Framework
from formation.graph.designs import all_before
from formation.laws.redundant import RedundantLaw
from formation.plane import as_complex

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.floats(0.1, 2.0))
def test_the_ratio_law_is_eq_u_but_for_a_positive_factor_that_bounds_the_speed(seed: int, speed: float) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    points = rng.normal(size=(6, 2)) * 10.0 ** rng.uniform(-2.0, 2.0)
    ratio = as_complex(Subject(LAWS["ratio"](target, speed=speed), target)(points))[2:]  # type: ignore[call-arg]
    paper = as_complex(Subject(AngleLaw(target), target)(points))[2:] / decay_rates(target)
    i, j = target.graph.neighbours.T
    p = as_complex(points)
    reach = np.abs(p[i] - p[2:]) + np.abs(p[j] - p[2:])
    np.testing.assert_allclose(ratio, speed * paper / reach, rtol=1e-7, atol=1e-9)
    star = as_complex(target.positions)
    w = (star[2:] - star[i]) / (star[j] - star[i])
    assert (np.abs(ratio) <= speed * np.maximum(np.abs(1.0 - w), np.abs(w)) * (1.0 + 1e-9)).all()


@given(seeds)
def test_two_seen_neighbours_give_the_papers_weights(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    law = RedundantLaw(target, rate=1.0)
    points = rng.normal(size=(6, 2))
    u, paper = (as_complex(Subject(each, target)(points)) for each in (law, AngleLaw(target)))
    np.testing.assert_allclose(u[2:] * decay_rates(target), paper[2:], atol=1e-9)


@given(seeds)
def test_least_norm_weights_are_those_of_the_pseudoinverse_whatever_is_seen(seed: int) -> None:
    rng = np.random.default_rng(seed)
    formation = Framework(all_before(random_target(6, rng)), rng.normal(size=(6, 2)))
    law, (k, i) = RedundantLaw(formation), formation.graph.edges.T
    seen = (rng.random(len(k)) < 0.6).astype(np.float64) * (k >= 2)
    weights = law.weights(seen)
    p = as_complex(formation.positions)
    for agent in range(2, 6):
        mine = np.flatnonzero((k == agent) & (seen > 0.0))
        assert not weights[(k == agent) & (seen == 0.0)].any()
        if len(mine) < 2:
            assert not weights[mine].any()
        else:
            conditions = np.stack([np.ones(len(mine)), p[i[mine]]])
            np.testing.assert_allclose(weights[mine], np.linalg.pinv(conditions) @ [1.0, p[agent]], atol=1e-8)


def switched(hold: float, runs: int, duration: float = 60.0, period: float = 0.02) -> np.ndarray:
    """(runs,) distances from the end of runs whose followers use a random pair, drawn anew every ``hold`` seconds."""
    rng = np.random.default_rng(0)
    target = random_target(6, rng, np.radians(15.0))
    formation = Framework(all_before(target), target.positions)
    law, (k, i) = RedundantLaw(formation, rate=1.0), formation.graph.edges.T
    points = rng.uniform(-1.5, 1.5, (runs, 6, 2))
    ends = np.stack([end_configuration(target, *start[:2]) for start in points])
    for step in range(round(duration / period)):
        if step % round(hold / period) == 0:
            order = rng.random((runs, len(k)))
            seen = ((order[:, None, :] < order[:, :, None]) & np.equal.outer(k, k)).sum(axis=-1) < 2
        relative = np.where(seen[..., None], points[:, i] - points[:, k], np.nan)
        points = points + period * law(relative)
    return np.linalg.norm(points - ends, axis=2).max(axis=1)


@pytest.mark.parametrize("hold", [0.02, 0.1, 1.0])
def test_any_switching_of_pairs_converges_to_the_same_place(hold: float) -> None:
    assert switched(hold, 300, duration=40.0).max() < 1e-6
