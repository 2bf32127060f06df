"""Graphs by their Laplacians, under the names and with the random draws of ``rps`` 1."""

from __future__ import annotations

import numpy as np

from robots.rps.columns import Real, whole
from robots.rps.version2.graph import Index, laplacian
from robots.rps.version2.graph import completeGL as completeGL
from robots.rps.version2.graph import delta_disk_neighbors as delta_disk_neighbors
from robots.rps.version2.graph import lineGL as lineGL
from robots.rps.version2.graph import topological_neighbors as topological_neighbors


def cycle_GL(N: int) -> Real:  # noqa: N802, N803 (named by rps, here and below)
    """(N, N) the Laplacian of the cycle; N from 3 on."""
    whole(3, N=N)
    return laplacian(N, np.arange(N), (np.arange(N) + 1) % N)


def random_connectedGL(v: int, e: int) -> Real:  # noqa: N802
    """(v, v) the Laplacian of a random tree, each node on one before it, with up to ``e`` edges more."""
    whole(1, v=v)
    whole(0, e=e)
    later = np.arange(1, v)
    earlier = np.array([np.random.randint(node) for node in later], dtype=np.intp)  # noqa: NPY002
    tree = laplacian(v, earlier, later)
    return tree + _some(np.argwhere(np.triu(tree == 0.0, 1)), v, e)


def randomGL(v: int, e: int) -> Real:  # noqa: N802
    """(v, v) the Laplacian of ``e`` random edges, or of all where there are fewer; it may fall into parts."""
    whole(1, v=v)
    whole(0, e=e)
    return _some(np.argwhere(np.triu(np.ones((v, v)), 1)), v, e)


def _some(candidates: Index, v: int, e: int) -> Real:
    """The Laplacian of ``e`` of the edges ``candidates`` (m, 2), or of all where there are fewer."""
    chosen = candidates[np.random.permutation(len(candidates))[:e]]  # noqa: NPY002
    return laplacian(v, *chosen.T)
