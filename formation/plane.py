"""Planar vectors as complex numbers.

Every matrix of the paper's linear constraint is a scaled rotation, so a vector (x, y) is handled as x + iy and a
scaled rotation as one complex factor. Public functions take and give real arrays (..., 2); these two views are the
only bridge, and neither copies a contiguous array.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def as_complex(vectors: ArrayLike) -> Complex:
    """View real vectors (..., 2) as complex numbers (...)."""
    return np.asarray(vectors, dtype=np.float64, order="C").view(np.complex128)[..., 0]


def as_vectors(numbers: ArrayLike) -> Real:
    """View complex numbers (...) as real vectors (..., 2)."""
    return np.asarray(numbers, dtype=np.complex128, order="C")[..., None].view(np.float64)


def rotation(theta: float) -> Real:
    """R(theta), the (2, 2) counter-clockwise rotation by ``theta`` radians (paper, Notations)."""
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, -s], [s, c]])
