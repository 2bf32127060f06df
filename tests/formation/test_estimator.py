"""The velocity estimator: it works exactly when the leader can be heard."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from formation import VelocityEstimator
from formation.estimator import unreachable


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(2, 12), gain=st.floats(0.1, 100.0), period=st.floats(0.001, 1.0))
def test_all_estimates_reach_the_leaders_velocity_on_any_graph_with_a_spanning_tree(
    seed: int, n: int, gain: float, period: float
) -> None:
    rng = np.random.default_rng(seed)
    tree = np.stack([np.arange(1, n), rng.integers(0, np.arange(1, n))], axis=1)
    extra = rng.integers(0, n, (n, 2))
    edges = np.concatenate([tree, extra[extra[:, 0] != extra[:, 1]]])
    estimator = VelocityEstimator(n, edges, gain)
    v_r = rng.normal(size=2)
    estimates = rng.normal(size=(n, 2))
    bound = np.abs(np.concatenate([estimates, [v_r]])).max()
    for _ in range(50):
        estimates = estimator.step(estimates, v_r, period)
        assert np.abs(estimates).max() <= bound + 1e-12  # convex combinations: stable for every gain and period
    one = np.tile(v_r, (n, 1))
    np.testing.assert_allclose(estimator.step(one, v_r, period), one, atol=1e-12)
    matrix = np.stack([estimator.step(np.eye(n)[:, [k, k]], np.eye(n)[0, [k, k]], period)[:, 0] for k in range(n)]).T
    assert np.abs(np.linalg.eigvals(matrix[1:, 1:])).max() < 1.0


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 10))
def test_agents_that_cannot_hear_from_the_leader_are_named(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    edges = rng.integers(0, n, (n, 2))
    lost = unreachable(n, edges)
    reach = np.eye(n, dtype=bool)
    adjacency = np.zeros((n, n), dtype=bool)
    adjacency[edges[:, 0], edges[:, 1]] = True
    for _ in range(n):
        reach |= adjacency @ reach
    np.testing.assert_array_equal(lost, np.flatnonzero(~reach[:, 0]))
    assume(lost.size)
    names = ", ".join(str(k + 1) for k in lost)
    who = "agent" if lost.size == 1 else "agents"
    with pytest.raises(ValueError, match=f"no spanning tree rooted at the leader: {who} {names} cannot hear"):
        VelocityEstimator(n, edges, 1.0)


def test_bad_edges_and_gains_are_refused() -> None:
    with pytest.raises(ValueError, match=r"edge \(2, 9\) names an agent outside 1\.\.3"):
        VelocityEstimator(3, [[1, 8]], 1.0)
    with pytest.raises(ValueError, match="gain must be a positive"):
        VelocityEstimator(2, [[1, 0]], 0.0)


@pytest.mark.parametrize("step", [0.01, 0.5, 3.0])
def test_an_estimate_covers_the_share_of_its_way_that_an_exponential_does(step: float) -> None:
    """Agent 2 hears the leader alone: after each period 1 - exp(-kappa h) of what was left is done, exactly."""
    estimator = VelocityEstimator(2, [[1, 0]], gain=2.0)
    estimates, velocity = np.zeros((2, 2)), np.array([0.3, -0.1])
    for periods in (1, 2, 3):
        estimates = estimator.step(estimates, velocity, step)
        np.testing.assert_allclose(estimates[1], (1.0 - np.exp(-2.0 * step * periods)) * velocity, rtol=1e-12)


def test_who_hears_nobody_keeps_its_estimate_and_the_others_average_what_they_hear() -> None:
    estimator = VelocityEstimator(3, [[1, 0], [2, 0], [2, 1]], 2.0)
    estimates = np.array([[9.0, 9.0], [0.0, 0.1], [0.3, 0.0]])
    heard = np.array([False, True, False])
    after = estimator.step(estimates, [0.5, 0.0], 0.1, heard)
    assert (after[1] == estimates[1]).all()
    np.testing.assert_allclose(after[2], estimates[2] + (1.0 - np.exp(-0.2)) * (np.array([0.5, 0.0]) - estimates[2]))
    everyone = estimator.step(estimates, [0.5, 0.0], 0.1, np.ones(3, dtype=bool))
    np.testing.assert_allclose(everyone, estimator.step(estimates, [0.5, 0.0], 0.1))
