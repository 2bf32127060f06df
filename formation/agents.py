"""Agent numbers and array rows.

The paper numbers agents 1..n, with the leader 1 and the first follower 2. People read and write those numbers;
arrays are indexed from 0. Every conversion between the two is here.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEADER = 0
FIRST_FOLLOWER = 1
FIRST_ORDINARY = 2
"""Rows of the leader, of the first follower and of the first follower that has two neighbours."""


def rows(numbers: ArrayLike) -> NDArray[np.intp]:
    """Array rows (0-based) of agents given by number (1-based), same shape."""
    return np.asarray(numbers, dtype=np.intp) - 1


def numbers(rows: ArrayLike) -> NDArray[np.intp]:
    """Agent numbers (1-based) of array rows (0-based), same shape."""
    return np.asarray(rows, dtype=np.intp) + 1


def number(row: int) -> int:
    """Agent number (1-based) of one array row (0-based)."""
    return int(row) + 1


def name(row: int) -> str:
    """How messages, tables and recordings name the agent in array row ``row``: ``"agent 3"``."""
    return f"agent {number(row)}"
