"""Noise, bias and disturbances become what the closed forms say."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import AngleLaw, TargetFormation, random_target
from formation.analysis.cascade import Cascade
from formation.analysis.noise import (
    bias_gains,
    bias_response,
    covariance,
    disturbance_bounds,
    noise_power,
    noise_rms,
)
from formation.plane import as_complex, as_vectors

PERIOD = 0.033
SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=20)
@given(seed=SEEDS, n=st.integers(3, 15), first_rate=st.sampled_from([0.0, 1.0]))
def test_the_covariance_solves_its_equation(seed: int, n: int, first_rate: float) -> None:
    target = random_target(n, np.random.default_rng(seed))
    loop = Cascade.of(target, first_rate)
    power = noise_power(loop, target.positions, 0.01, 0.02)
    x = covariance(loop, PERIOD, power)
    f = np.eye(n) + PERIOD * loop.whole
    push = loop.apply(bias_response(loop))
    expected = f @ x @ np.conj(f).T + PERIOD**2 * (push * power) @ np.conj(push).T
    np.testing.assert_allclose(x, expected, atol=1e-12 * np.abs(x).max())


def test_noise_of_the_papers_shape_is_that_of_many_runs(paper: TargetFormation) -> None:
    rng, runs, steps = np.random.default_rng(3), 400, 1200
    law, edges = AngleLaw(paper), paper.graph.edges
    p = np.tile(paper.positions, (runs, 1, 1))
    squares = np.zeros(6)
    for step in range(steps):
        relative = p[:, edges[:, 1]] - p[:, edges[:, 0]] + rng.normal(0.0, 0.01, (runs, len(edges), 2))
        p = p + PERIOD * law(relative)
        if step >= 400:
            squares += ((p - paper.positions) ** 2).sum(axis=-1).mean(axis=0)
    loop = Cascade.of(paper)
    predicted = noise_rms(loop, PERIOD, noise_power(loop, paper.positions, 0.01))
    np.testing.assert_allclose(np.sqrt(squares / (steps - 400)), predicted, rtol=0.03)
    np.testing.assert_allclose(1e3 * predicted[2:], [2.234, 2.241, 2.915, 2.915], atol=1e-3)


def test_a_follower_of_settled_neighbours_has_the_noise_of_one_formula(paper: TargetFormation) -> None:
    loop = Cascade.of(paper)
    a, w = loop.rates[1], loop.weights[0]
    expected = a * PERIOD * 2e-4 * (abs(1 - w) ** 2 + abs(w) ** 2) / (2.0 - a * PERIOD)
    assert noise_rms(loop, PERIOD, noise_power(loop, paper.positions, 0.01))[2] ** 2 == pytest.approx(expected)


@settings(max_examples=20)
@given(seed=SEEDS)
def test_a_constant_bias_leaves_the_agents_where_the_response_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng, min_angle=np.radians(30.0))
    bias = rng.normal(0.0, 0.01, (9, 2))
    edges = target.graph.edges
    p = target.positions + as_vectors(np.r_[0, 0, bias_response(Cascade.of(target))[2:] @ as_complex(bias)])
    u = AngleLaw(target)(p[edges[:, 1]] - p[edges[:, 0]] + bias)
    np.testing.assert_allclose(u, 0.0, atol=1e-9)


def test_the_gain_of_a_bias_in_the_papers_shape(paper: TargetFormation) -> None:
    np.testing.assert_allclose(bias_gains(Cascade.of(paper))[2:], [1.732, 1.581, 2.372, 2.372], atol=1e-3)


@settings(max_examples=10)
@given(seed=SEEDS)
def test_no_bounded_disturbance_pushes_an_agent_beyond_its_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    loop = Cascade.of(target, 1.0)
    bounds, p, size = disturbance_bounds(loop, 0.01), np.zeros(6, dtype=complex), 0.01
    direction = np.exp(2j * np.pi * rng.uniform(size=6))
    for step in range(2000):
        if step % 50 == 0:
            direction = np.exp(2j * np.pi * rng.uniform(size=6))
        push = size * direction
        push[0] = 0.0
        p = p + 0.02 * (loop.apply(p) + push)
        assert (np.abs(p) <= bounds + 1e-12).all()


def test_disturbances_of_a_centimetre_a_second_in_the_papers_shape(paper: TargetFormation) -> None:
    np.testing.assert_allclose(
        disturbance_bounds(Cascade.of(paper), 0.01)[2:], [0.02, 0.0241, 0.0426, 0.0426], atol=1e-4
    )


@settings(max_examples=20)
@given(seed=SEEDS)
def test_measured_positions_err_by_noise_of_place_and_of_direction_as_many_draws_do(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(5, rng)
    loop = Cascade.of(target)
    observer, observed = target.graph.edges.T
    e = as_complex(target.positions[observed] - target.positions[observer])
    sigma, turn = rng.uniform(0.01, 0.3), rng.uniform(0.1, 1.5)
    draws = (20_000, len(e))
    noise = rng.normal(0.0, sigma, draws) + 1j * rng.normal(0.0, sigma, draws)
    measured = e * np.exp(1j * rng.normal(0.0, turn, draws)) + noise
    expected = (np.abs(measured - e) ** 2).mean(axis=0)
    np.testing.assert_allclose(noise_power(loop, target.positions, sigma, turn), expected, rtol=0.05)
    np.testing.assert_allclose(noise_power(loop, target.positions, sigma), 2.0 * sigma**2)


@given(seed=SEEDS, first_rate=st.sampled_from([0.0, 0.5, 1.0]), size=st.floats(0.001, 1.0))
def test_disturbances_that_all_push_the_worst_way_reach_the_bound(seed: int, first_rate: float, size: float) -> None:
    """Row by row: with a moving first follower it is where a loop of the pulls' absolute values comes to rest."""
    target = random_target(6, np.random.default_rng(seed))
    loop = Cascade.of(target, first_rate)
    worst = np.eye(6)
    for k, (i, j) in enumerate(target.graph.neighbours.tolist(), start=2):
        worst[k, [i, j]] -= np.abs(loop.pulls[k - 2])
    push = np.concatenate([[0.0, size / first_rate if first_rate else 0.0], size / loop.rates[1:]])
    np.testing.assert_allclose(disturbance_bounds(loop, size), np.linalg.solve(worst, push), atol=1e-12)


def test_a_biased_first_follower_takes_all_others_with_it_if_it_moves_at_all() -> None:
    target = random_target(5, np.random.default_rng(3))
    moving, standing = (bias_response(Cascade.of(target, rate))[:, 0] for rate in (0.3, 0.0))
    z = as_complex(target.positions)
    np.testing.assert_allclose(moving, (z - z[0]) / (z[1] - z[0]))
    assert not standing.any()
    assert bias_response(Cascade.of(target)).shape == (5, 7)


def test_at_the_longest_period_an_agent_and_all_that_follow_it_are_infinitely_far_off(paper: TargetFormation) -> None:
    cascade = Cascade.of(paper, 1.0)
    found = noise_rms(cascade, 2.0, noise_power(cascade, paper.positions, 0.01))
    assert found[0] == 0.0
    assert np.isinf(found[1:]).all()
