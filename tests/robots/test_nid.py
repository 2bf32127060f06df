"""The near-identity diffeomorphism."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import NearIdentityDiffeomorphism

distances = st.floats(1e-3, 0.5)
numbers = st.floats(-5.0, 5.0)
pairs = st.tuples(numbers, numbers).map(np.array)


@given(distances, pairs)
def test_velocity_and_twist_are_inverse_to_each_other(distance: float, velocity: np.ndarray) -> None:
    nid = NearIdentityDiffeomorphism(distance)
    np.testing.assert_allclose(nid.velocity(nid.twist(velocity)), velocity, atol=1e-14)


@given(distances, pairs, st.floats(-10.0, 10.0))
def test_projecting_and_placing_are_inverse_to_each_other(distance: float, point: np.ndarray, theta: float) -> None:
    nid = NearIdentityDiffeomorphism(distance)
    pose = nid.poses(point, np.asarray(theta))
    assert pose[2] == theta
    assert np.linalg.norm(pose[:2] - point) == pytest.approx(distance)
    np.testing.assert_allclose(nid.project(pose), point, atol=1e-14)


@given(distances, pairs, st.floats(-np.pi, np.pi))
def test_the_twist_moves_the_projected_point_at_the_asked_velocity(
    distance: float, velocity: np.ndarray, theta: float
) -> None:
    """Central difference of the projection along the unicycle's motion."""
    nid = NearIdentityDiffeomorphism(distance)
    v, omega = nid.twist(velocity)
    h = 1e-5 / (1.0 + abs(omega))

    def pose(t: float) -> np.ndarray:  # second order in t, as the difference is
        middle = theta + omega * t / 2.0
        return np.array([v * t * np.cos(middle), v * t * np.sin(middle), theta + omega * t])

    measured = (nid.project(pose(h)) - nid.project(pose(-h))) / (2.0 * h)
    c, s = np.cos(theta), np.sin(theta)
    np.testing.assert_allclose(measured, np.array([[c, -s], [s, c]]) @ velocity, atol=1e-4)


@pytest.mark.parametrize("distance", [0.0, -0.05, np.nan, np.inf])
def test_the_singular_map_is_refused(distance: float) -> None:
    with pytest.raises(ValueError, match="projection_distance must be a positive number of m"):
        NearIdentityDiffeomorphism(distance)
