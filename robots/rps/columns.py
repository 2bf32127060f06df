"""What the utilities share: arrays whose columns are robots, checked where they come in, and turned between frames."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Real = NDArray[np.float64]


def columns(name: str, given: ArrayLike, rows: int, n: int | None = None) -> Real:
    """``given`` as an array (rows, N).

    Raises:
        ValueError: it has another number of rows, or of columns where ``n`` says how many; by its ``name``.
    """
    array = np.asarray(given, dtype=np.float64)
    if array.ndim != 2 or array.shape[0] != rows or n not in (None, array.shape[1]):
        raise ValueError(f"{name} must have the shape ({rows}, {'N' if n is None else n}), got {array.shape}")
    return array


def positive(**given: float) -> None:
    """Refuse what is not a positive number.

    Raises:
        ValueError: by the name of the argument.
    """
    for name, value in given.items():
        if not (isinstance(value, int | float | np.number) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")


def not_negative(**given: float) -> None:
    """Refuse what is not a number, or is negative.

    Raises:
        ValueError: by the name of the argument.
    """
    for name, value in given.items():
        if not (isinstance(value, int | float | np.number) and value >= 0):
            raise ValueError(f"{name} must be a number that is not negative, got {value!r}")


def whole(at_least: int, **given: int) -> None:
    """Refuse what is not a whole number from ``at_least`` on.

    Raises:
        ValueError: by the name of the argument.
    """
    for name, value in given.items():
        if not (isinstance(value, int | np.integer) and value >= at_least):
            raise ValueError(f"{name} must be a whole number from {at_least} on, got {value!r}")


def along(vectors: Real, theta: Real) -> Real:
    """(2, N) the parts of world-frame vectors (2, N) along headings theta (N,) and to their left.

    A zero has no sign: where a vector vanishes, its direction is the heading's.
    """
    c, s = np.cos(theta), np.sin(theta)
    x, y = vectors
    return np.array([c * x + s * y, c * y - s * x]) + 0.0


def across(parts: Real, theta: Real) -> Real:
    """(2, N) world-frame vectors of their parts (2, N) along headings theta (N,) and to their left."""
    c, s = np.cos(theta), np.sin(theta)
    forward, left = parts
    return np.array([c * forward - s * left, s * forward + c * left])


def ahead(states: Real, distance: float) -> Real:
    """(2, N) points at ``distance``, metres, ahead of poses (3, N)."""
    return states[:2] + distance * np.array([np.cos(states[2]), np.sin(states[2])])


def wrapped(angle: Real) -> Real:
    """Angles within half a turn, radians."""
    return np.arctan2(np.sin(angle), np.cos(angle))


def limited(vectors: Real, limit: float) -> Real:
    """(2, N) the vectors (2, N), shortened to ``limit`` where they are longer."""
    lengths = np.linalg.norm(vectors, axis=0)
    return vectors * (limit / np.maximum(lengths, max(limit, np.finfo(float).tiny)))
