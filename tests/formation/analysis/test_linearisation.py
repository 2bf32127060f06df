"""The derivative of a closed loop is what theory says, errs by no more than it admits, and knows its clock."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import AngleLaw, closed_loop_matrix, random_target
from formation.analysis.linearisation import Linearisation, linearise
from formation.audit import Subject
from formation.plane import as_complex

SEEDS = st.integers(0, 2**32 - 1)


@given(seed=SEEDS, n=st.integers(3, 12), first_follower=st.sampled_from(["stationary", "displacement"]))
def test_the_modes_of_the_angle_law_are_minus_sin_squared_of_the_follower_angles(
    seed: int, n: int, first_follower: str
) -> None:
    target = random_target(n, np.random.default_rng(seed))
    loop = Subject(AngleLaw(target, first_follower), target, (0.3, 0.4)).loop
    rates = np.concatenate([[0.0, float(first_follower == "displacement")], np.sin(target.follower_angles) ** 2])
    assert loop.cascade
    np.testing.assert_allclose(loop.modes, np.repeat(-rates[:, None], 2, axis=1), atol=1e-6)
    assert loop.zero_modes == (2 if first_follower == "displacement" else 4)


@given(seed=SEEDS)
def test_the_derivative_errs_by_no_more_than_its_bound(seed: int) -> None:
    target = random_target(7, np.random.default_rng(seed))
    loop = Subject(AngleLaw(target), target).loop
    exact = closed_loop_matrix(target)
    blocks = loop.matrix.reshape(7, 2, 7, 2)[1:, :, 1:, 0]
    error = np.abs(as_complex(blocks.transpose(0, 2, 1)) - exact).max()
    assert error <= loop.bound + 1e-11
    assert loop.bound < 1e-9


@given(x=st.floats(-0.5, 0.5))
def test_the_bound_covers_the_error_on_a_curved_law(x: float) -> None:
    points = np.array([[x, 0.0], [0.0, 0.0]])
    loop = linearise(lambda p: np.stack([np.sin(3.0 * p[:, 0]), np.exp(p[:, 1])], axis=1), points, 1e-3)
    exact = np.diag([3.0 * np.cos(3.0 * x), 1.0, 3.0, 1.0])
    assert np.abs(loop.matrix - exact).max() <= loop.bound + 1e-11


@pytest.mark.parametrize("bent", [np.abs, lambda x: np.maximum(x, 0.0), np.cbrt, np.sign])
def test_a_kink_or_a_jump_is_no_derivative(bent: object) -> None:
    loop = linearise(bent, np.zeros((1, 2)), 1e-3)  # type: ignore[arg-type]
    assert loop.bound > 0.1
    assert not loop.smooth


def test_a_number_that_is_not_finite_is_no_derivative() -> None:
    with np.errstate(all="ignore"):
        loop = linearise(lambda p: p / np.zeros_like(p), np.zeros((1, 2)), 1e-3)
    assert not loop.smooth


@given(rate=st.floats(0.01, 50.0), turn=st.floats(-20.0, 20.0))
def test_a_held_command_is_stable_below_the_largest_period_and_not_above(rate: float, turn: float) -> None:
    loop = Linearisation(np.array([[-rate, -turn], [turn, -rate]]), 0.0)
    longest = loop.largest_period

    def gain(period: float) -> float:
        return float(np.abs(np.linalg.eigvals(np.eye(2) + period * loop.matrix)).max())

    assert gain(0.99 * longest) < 1.0 < gain(1.01 * longest)


def test_a_loop_at_rest_takes_any_period_and_one_that_grows_takes_none() -> None:
    assert Linearisation(np.zeros((4, 4)), 0.0).largest_period == np.inf
    assert Linearisation(np.diag([-1.0, 2.0]), 0.0).largest_period == 0.0


def test_the_modes_of_a_long_cascade_of_equal_rates_do_not_blur() -> None:
    """All eigenvalues of the whole matrix at once would be off by a tenth here."""
    matrix = np.kron(np.eye(20, k=-1), 5.0 * np.eye(2)) - 0.5 * np.eye(40)
    matrix[np.tril_indices(40, -4)] += 1e-13
    np.testing.assert_allclose(Linearisation(matrix, 0.0).modes, -0.5, atol=1e-6)


def test_a_loop_that_is_no_cascade_has_the_modes_of_the_whole() -> None:
    loop = Linearisation(np.kron(np.array([[-1.0, 1.0], [1.0, -1.0]]), np.eye(2)), 0.0)
    assert not loop.cascade
    np.testing.assert_allclose(np.sort(loop.modes.real.ravel()), [-2.0, -2.0, 0.0, 0.0], atol=1e-12)
    assert loop.zero_modes == 2


def test_modes_come_two_for_each_agent_whether_the_loop_is_a_cascade_or_not() -> None:
    coupled = Linearisation(np.random.default_rng(0).normal(size=(6, 6)), 0.0)
    assert not coupled.cascade
    assert (coupled.n, coupled.modes.shape) == (3, (3, 2))
    apart = Linearisation(np.kron(np.diag([-1.0, -2.0, -3.0]), np.eye(2)), 0.0)
    assert apart.cascade
    np.testing.assert_allclose(apart.modes, [[-1.0, -1.0], [-2.0, -2.0], [-3.0, -3.0]])


def test_of_a_parabola_the_derivative_is_exact_and_of_a_kink_the_bound_is_its_jump() -> None:
    parabola = linearise(lambda p: p + 3.0 * p**2, np.zeros((1, 2)), 0.1)
    np.testing.assert_allclose(parabola.matrix, np.eye(2), atol=1e-13)
    assert parabola.bound < 1e-12
    for sign in (1.0, -1.0):
        kink = linearise(lambda p, sign=sign: sign * np.abs(p) + 5.0 * p**2, np.zeros((1, 2)), 0.1)  # type: ignore[misc]
        assert kink.bound == pytest.approx(2.0)
