"""The target formation and Assumption 2."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import SensingGraph, Similarity, TargetFormation

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
GRAPH = SensingGraph(np.array([[0, 1], [1, 2]]))


def moved(row: int, place: tuple[float, float]) -> np.ndarray:
    points = SQUARE.copy()
    points[row] = place
    return points


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (SQUARE[:3], r"shape \(4, 2\), got \(3, 2\)"),
        (moved(2, (np.nan, 0.0)), "target position of agent 3 is not finite"),
        (moved(3, (0.0, np.inf)), "target position of agent 4 is not finite"),
        (moved(1, (0.0, 0.0)), "leader and first follower coincide"),
        (moved(2, (2.0, 0.0)), r"triangle \(1, 2, 3\) is degenerate, agent 3 is collinear"),
        (moved(3, (0.5, 0.5)), r"triangle \(2, 3, 4\) is degenerate, agent 4 is collinear"),
        (moved(3, (0.0, 1.0)), r"triangle \(2, 3, 4\) is degenerate"),
    ],
)
def test_a_target_without_a_shape_is_refused(points: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TargetFormation(GRAPH, points)


@given(st.floats(0.1, 10.0), st.floats(0.0, 6.28), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_the_residual_vanishes_on_the_orbit_of_the_shape(c: float, theta: float, x: float, y: float) -> None:
    target = TargetFormation(GRAPH, SQUARE)
    assert np.abs(target.residual(Similarity(c, theta, (x, y))(SQUARE))).max() < 1e-12 * (1.0 + c)


def test_the_residual_names_the_triangle_that_lost_its_shape() -> None:
    residual = TargetFormation(GRAPH, SQUARE).residual(moved(3, (1.2, 1.0)))
    assert np.abs(residual[0]).max() < 1e-15
    assert np.linalg.norm(residual[1]) == pytest.approx(0.2)  # |A_k| = sin 90 degrees


def test_a_batch_of_residuals_equals_each_residual() -> None:
    target = TargetFormation(GRAPH, SQUARE)
    batch = np.random.default_rng(0).normal(size=(5, 4, 2))
    assert (target.residual(batch)[3] == target.residual(batch[3])).all()


def test_a_target_keeps_its_own_copy() -> None:
    given_points = SQUARE.copy()
    target = TargetFormation(GRAPH, given_points)
    given_points[0] = 9.0
    assert (target.positions == SQUARE).all()
    with pytest.raises(ValueError, match="read-only"):
        target.positions[0] = 9.0
