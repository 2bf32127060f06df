"""The loops that a compiler takes compute the angle law, whoever the first follower listens to, in any frames."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import EDGE_LAWS, AngleLaw, random_target
from formation.laws.angle_loop import FIRST_FOLLOWERS, feedback, gains
from formation.laws.feedforward import FeedForward
from formation.plane import as_complex, as_vectors


def test_the_numbers_of_the_loops_stand_for_the_laws_of_the_first_follower() -> None:
    assert set(FIRST_FOLLOWERS) == set(EDGE_LAWS)


@pytest.mark.parametrize("first_follower", FIRST_FOLLOWERS)
@settings(max_examples=20)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(2, 7))
def test_the_loops_give_each_run_the_velocities_of_the_law_in_body_frames(
    first_follower: str, seed: int, n: int
) -> None:
    rng, runs = np.random.default_rng(seed), 3
    target = random_target(max(n, 3), rng)
    n = target.graph.n
    law = AngleLaw(target, first_follower, rng.uniform(0.5, 2.0, n - 2))
    heading = rng.uniform(-np.pi, np.pi, (runs, n))
    delta = rng.normal(size=2)
    p = as_complex(rng.normal(size=(runs, n, 2)))
    k, i = target.graph.edges.T
    relative = as_vectors((p[:, i] - p[:, k]) * np.exp(-1j * heading[:, k]))
    rate = complex(*rng.normal(size=2))
    expected = law(relative, as_vectors(np.exp(-1j * heading)), delta) + FeedForward(target)(relative, rate)
    gx, gy = np.full((2, n, runs), np.nan)
    c, s = np.cos(heading).T, np.sin(heading).T
    told = float(delta[0]), float(delta[1]), rate.real, rate.imag
    feedback(relative.transpose(2, 1, 0), c, s, gains(law, target, first_follower), *told, gx, gy)
    np.testing.assert_allclose(gx.T, expected[..., 0], atol=1e-9)
    np.testing.assert_allclose(gy.T, expected[..., 1], atol=1e-9)


def test_opposite_to_its_end_the_spiral_of_the_loops_turns_clockwise_too() -> None:
    target = random_target(3, np.random.default_rng(0))
    law = AngleLaw(target, "spiral")
    for nudge in (1e-9, 0.0, -1e-9):
        relative = np.array([[1.0, nudge], [1.0, 1.0], [-1.0, 1.0]])  # from agent 2, agent 1 is to the right
        expected = law(relative, np.tile([1.0, 0.0], (3, 1)), np.array([1.0, 0.0]))
        gx, gy = np.zeros((2, 3, 1))
        loops = gains(law, target, "spiral")
        feedback(relative.T[..., None], np.ones((3, 1)), np.zeros((3, 1)), loops, 1.0, 0.0, 0.0, 0.0, gx, gy)
        assert gy[1, 0] == pytest.approx(expected[1, 1]) == pytest.approx(np.pi, abs=1e-5)
