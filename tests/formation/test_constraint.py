"""The linear constraint of one triangle, eq. (clm)."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from formation import Similarity, constraint_coefficients, interior_angles
from formation.plane import as_complex

coordinates = st.floats(-5.0, 5.0)
triangles = st.tuples(*[st.tuples(coordinates, coordinates)] * 3).map(np.array)
radians = st.floats(0.0, 2.0 * np.pi)


def flatness(corners: np.ndarray) -> float:
    """Smallest sine of the triangle's angles: 0 for three points on a line."""
    return float(np.abs(np.sin(interior_angles(*corners))).min())


def residual(angles: np.ndarray, corners: np.ndarray) -> float:
    """|A_i p_i + A_j p_j + A_k p_k|."""
    return float(np.abs((constraint_coefficients(angles) * as_complex(corners)).sum()))


def nondegenerate(corners: np.ndarray) -> bool:
    sides = np.abs(np.diff(as_complex(corners), append=as_complex(corners)[0]))
    return bool(sides.min() > 0.05) and flatness(corners) > 0.01


@given(triangles, st.floats(0.1, 10.0), radians, st.tuples(coordinates, coordinates))
def test_the_constraint_holds_for_every_similarity_of_the_triangle(
    corners: np.ndarray, scale: float, theta: float, xi: tuple[float, float]
) -> None:
    assume(nondegenerate(corners))
    moved = Similarity(scale, theta, xi)(corners)
    assert residual(interior_angles(*corners), moved) < 1e-11 * (1.0 + np.abs(moved).max())


@given(triangles, triangles)
def test_the_constraint_holds_for_nothing_but_similarities(corners: np.ndarray, other: np.ndarray) -> None:
    assume(nondegenerate(corners) and nondegenerate(other))
    angles = interior_angles(*corners)
    p, q = as_complex(corners), as_complex(other)
    # The similarity that takes corners i and j to those of the other triangle takes corner k here:
    expected = q[0] + (q[1] - q[0]) * (p[2] - p[0]) / (p[1] - p[0])
    # and the constraint's residual is that corner's distance, scaled by |A_k| = |sin a_k|.
    assert residual(angles, other) == pytest.approx(abs(np.sin(angles[2])) * abs(q[2] - expected), abs=1e-9)


@given(triangles)
def test_the_mirrored_triangle_breaks_the_constraint(corners: np.ndarray) -> None:
    assume(nondegenerate(corners))
    assert residual(interior_angles(*corners), corners * [1.0, -1.0]) > 1e-6


@given(triangles)
def test_interior_angles_turn_the_same_way_and_add_up_to_pi_or_5_pi(corners: np.ndarray) -> None:
    assume(nondegenerate(corners))
    i, j, k = corners
    clockwise = np.linalg.det(np.stack([j - k, i - k])) < 0.0
    assert interior_angles(i, j, k).sum() == pytest.approx(np.pi * (5.0 if clockwise else 1.0))


@given(triangles)
def test_the_coefficients_add_up_to_zero_so_that_translations_cancel(corners: np.ndarray) -> None:
    assume(nondegenerate(corners))
    assert np.abs(constraint_coefficients(interior_angles(*corners)).sum()) < 1e-15


@given(triangles)
def test_the_determinant_of_the_followers_matrix_is_the_squared_sine_of_its_angle(corners: np.ndarray) -> None:
    """Resolution 3: names by vertex make det A_k = sin^2(a_k) > 0."""
    assume(nondegenerate(corners))
    angles = interior_angles(*corners)
    a_k = constraint_coefficients(angles)[2]
    assert np.abs(a_k) ** 2 == pytest.approx(np.sin(angles[2]) ** 2)
    assert a_k.imag == 0.0


@given(triangles)
def test_complex_coefficients_are_the_matrices_of_the_paper(corners: np.ndarray) -> None:
    assume(nondegenerate(corners))
    a_i, a_j, a_k = angles = interior_angles(*corners)

    def turned(angle: float) -> np.ndarray:
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    paper = [
        np.sin(a_k) * np.eye(2) - np.sin(a_j) * turned(a_i).T,
        np.sin(a_j) * turned(a_i).T,
        -np.sin(a_k) * np.eye(2),
    ]
    for matrix, c in zip(paper, constraint_coefficients(angles), strict=True):
        np.testing.assert_allclose([[c.real, -c.imag], [c.imag, c.real]], matrix, atol=1e-14)
