"""The joint filters' QP: the rows that it begins without change nothing, and a crowd does not need them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism
from robots.safety import FilterSettings, make_filter
from robots.safety.joint import JointFilter, nearest

NID = NearIdentityDiffeomorphism(0.025)
PERIOD = 0.033
ARENA = Arena((-1.5, 1.5), (-1.5, 1.5))


def build(name: str, n: int) -> JointFilter:
    safety = make_filter(name, (n,), GTERNAL.drive, NID, FilterSettings(), ARENA)
    assert isinstance(safety, JointFilter)
    return safety


def at_once(safety: JointFilter, points: np.ndarray, law: np.ndarray) -> np.ndarray:
    """The same QP with all its rows, of robots that head along the x axis, where body and world frames agree."""
    frame, still = np.ones((len(points), 1), dtype=np.complex128), np.zeros_like(law)
    rows = safety._rows(0, points, frame, None)
    directions, limit = safety._wheels(frame)
    hard = np.zeros((*directions.shape[:2], len(points), 2))
    hard[np.arange(len(points)), :, np.arange(len(points))] = directions
    wish = safety._wish(law, still, frame)
    hard = hard.reshape(-1, 2 * len(points))
    v, relaxation = nearest(wish, rows.matrix(len(points)), rows.lower, hard, limit)
    assert relaxation == 0.0
    return v


def filtered(safety: JointFilter, points: np.ndarray, law: np.ndarray) -> np.ndarray:
    return safety.filter(points, np.tile([1.0, 0.0], (len(points), 1)), law, np.zeros_like(law), PERIOD)


@pytest.mark.parametrize("name", ["centralised", "robotarium"])
@given(seed=st.integers(0, 10**6))
def test_the_solution_is_that_of_the_qp_with_all_rows(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) * 0.21 - 0.3
    points, law = grid + rng.uniform(-0.019, 0.019, grid.shape), rng.normal(0.0, 0.15, grid.shape)
    safety = build(name, 16)
    np.testing.assert_allclose(filtered(safety, points, law), at_once(safety, points, law), atol=2e-6)


def test_a_robot_that_is_pushed_does_not_push_through_the_next() -> None:
    """Robots 1 and 2 wish to stand still, so that the row between them is not there until robot 0 pushes."""
    points = np.array([[0.0, 0.0], [0.157, 0.0], [0.314, 0.0]])
    law = np.array([[0.2, 0.0], [0.0, 0.0], [0.0, 0.0]])
    safety = build("centralised", 3)
    v = filtered(safety, points, law)
    assert v[1, 0] > 0.05
    np.testing.assert_allclose(v, at_once(safety, points, law), atol=2e-6)


def test_robots_far_apart_bring_no_rows_into_the_certificates_qp(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []

    def counted(wish: np.ndarray, matrix: np.ndarray, *rest: object) -> tuple[np.ndarray, float]:
        sizes.append(len(matrix))
        return nearest(wish, matrix, *rest)

    monkeypatch.setattr("robots.safety.joint.nearest", counted)
    points = np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) * 0.6 - 0.9
    filtered(build("robotarium", 16), points, np.full((16, 2), 0.1))
    assert sum(sizes) == 0
