"""The two-variable solver against a general one."""

from __future__ import annotations

import daqp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.safety import solver

SPEED, WEIGHT = 0.2, 2.2
PROBLEMS = 2500
KINDS = ("general", "parallel", "on a grid of directions", "through one point")


def problem(kind: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Rows (m, 3), the wheels' first, and the point wished for."""
    m = int(rng.integers(0, 9))
    angle = rng.uniform(-np.pi, np.pi, m)
    lower = rng.normal(-0.05, 0.1, m)
    if kind == "parallel":
        angle = angle[:1] + np.pi * rng.integers(0, 2, m)
    elif kind == "on a grid of directions":
        angle = np.round(angle / (np.pi / 4)) * (np.pi / 4)
    rows = np.empty((solver.WHEEL_ROWS + m, 3))
    solver.wheel_rows(rows, SPEED, WEIGHT)
    rows[solver.WHEEL_ROWS :] = np.stack([np.cos(angle), np.sin(angle), lower], axis=1)
    if kind == "through one point":
        rows[solver.WHEEL_ROWS :, 2] = rows[solver.WHEEL_ROWS :, :2] @ rng.uniform(-0.05, 0.05, 2)
    return rows, rng.normal(0.0, 0.2, 2)


def solved(rows: np.ndarray, wish: np.ndarray) -> tuple[np.ndarray, float]:
    x, y, relaxation = solver.project(rows.copy(), len(rows), np.empty_like(rows), SPEED, WEIGHT, *wish)
    return np.array([x, y]), relaxation


def general(rows: np.ndarray, wish: np.ndarray) -> tuple[np.ndarray, bool]:
    m = len(rows)
    upper, sense = np.full(m, 1e30), np.zeros(m, dtype=np.int32)
    x, _, flag, _ = daqp.solve(
        np.eye(2), -wish, rows[:, :2].copy(), upper, rows[:, 2].copy(), sense, primal_tol=1e-13, dual_tol=1e-13
    )
    return x, flag == 1


def lowered(rows: np.ndarray, by: float) -> np.ndarray:
    relaxed = rows.copy()
    relaxed[solver.WHEEL_ROWS :, 2] -= by
    return relaxed


@pytest.mark.parametrize("kind", KINDS)
def test_it_agrees_with_a_general_solver_on_2500_problems_of_each_kind(kind: str) -> None:
    rng = np.random.default_rng(KINDS.index(kind))
    infeasible = 0
    for _ in range(PROBLEMS):
        rows, wish = problem(kind, rng)
        u, relaxation = solved(rows, wish)
        if relaxation == 0.0:
            expected, found = general(rows, wish)
            assert found
            np.testing.assert_allclose(u, expected, rtol=0.0, atol=1e-9)
            continue
        infeasible += 1
        assert not general(lowered(rows, relaxation - 1e-9), wish)[1]
        expected, found = general(lowered(rows, relaxation + 1e-11), wish)
        assert found
        assert (rows[:, :2] @ u >= lowered(rows, relaxation)[:, 2] - 1e-11).all()
        np.testing.assert_allclose(u, expected, rtol=0.0, atol=1e-6)

    assert kind == "through one point" or infeasible > 200


@given(seed=st.integers(0, 10**6), kind=st.sampled_from(KINDS))
def test_the_order_of_the_rows_does_not_matter(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    rows, wish = problem(kind, rng)
    u, relaxation = solved(rows, wish)
    shuffled = np.concatenate([rows[: solver.WHEEL_ROWS], rng.permutation(rows[solver.WHEEL_ROWS :])])
    again, relaxed_again = solved(shuffled, wish)
    np.testing.assert_allclose(relaxed_again, relaxation, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(again, u, rtol=0.0, atol=1e-6 if relaxation else 1e-9)


@given(seed=st.integers(0, 10**6), kind=st.sampled_from(KINDS))
def test_the_wheels_are_never_relaxed(seed: int, kind: str) -> None:
    rows, wish = problem(kind, np.random.default_rng(seed))
    u, _ = solved(rows, wish)
    assert abs(u[0]) + WEIGHT * abs(u[1]) <= SPEED + 1e-11


def test_without_rows_a_feasible_wish_is_returned_unchanged() -> None:
    rows = np.empty((solver.WHEEL_ROWS, 3))
    solver.wheel_rows(rows, SPEED, WEIGHT)
    u, relaxation = solved(rows, np.array([0.1, -0.02]))
    assert u.tolist() == [0.1, -0.02]
    assert relaxation == 0.0
