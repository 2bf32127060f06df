"""The angle-induced linear constraint of one triangle (paper, eq. (clm)).

For the triangle (i, j, k) with the interior signed angles

    a_i = alpha(i; k, j),   a_j = alpha(j; i, k),   a_k = alpha(k; j, i),

the linear constraint

    A_i = sin(a_k) I - sin(a_j) R(a_i)^T,   A_j = sin(a_j) R(a_i)^T,   A_k = -sin(a_k) I,
    A_i p_i + A_j p_j + A_k p_k = 0

holds for every configuration of that shape and for no other. All three matrices are scaled rotations, so each is one
complex number here and they commute with every rotation.
"""

import numpy as np
from numpy.typing import ArrayLike

from formation.angles import signed_angle
from formation.plane import Complex, Real


def interior_angles(p_i: ArrayLike, p_j: ArrayLike, p_k: ArrayLike) -> Real:
    """The interior signed angles (..., 3) at i, j and k, radians, of triangles with corners (..., 2).

    All three turn the same way: they add up to pi for a counter-clockwise triangle (k, j, i) and to 5 pi otherwise.
    """
    return np.stack([signed_angle(p_i, p_k, p_j), signed_angle(p_j, p_i, p_k), signed_angle(p_k, p_j, p_i)], axis=-1)


def constraint_coefficients(angles: ArrayLike) -> Complex:
    """The matrices A_i, A_j, A_k of eq. (clm) as complex numbers (..., 3), from interior angles (..., 3)."""
    a_i, a_j, a_k = np.moveaxis(np.asarray(angles, dtype=np.float64), -1, 0)
    c_j = np.sin(a_j) * np.exp(-1j * a_i)  # sin(a_j) R(a_i)^T
    c_k = -np.sin(a_k).astype(np.complex128)
    return np.stack([-c_k - c_j, c_j, c_k], axis=-1)
