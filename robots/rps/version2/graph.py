"""Graphs by their Laplacians L = D - A, and who is whose neighbour, as in ``rps`` 2.1.

Random graphs are drawn from numpy's global generator, as scripts that seed it expect.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.rps.columns import Real, whole

Index = NDArray[np.intp]


def completeGL(n: int) -> Real:  # noqa: N802 (named by rps, here and below)
    """(n, n) the Laplacian of the complete graph."""
    whole(1, n=n)
    return n * np.eye(n) - np.ones((n, n))


def cycleGL(n: int) -> Real:  # noqa: N802
    """(n, n) the Laplacian of the cycle; n from 3 on."""
    whole(3, n=n)
    return laplacian(n, np.arange(n), (np.arange(n) + 1) % n)


def lineGL(n: int) -> Real:  # noqa: N802
    """(n, n) the Laplacian of the path; n from 2 on."""
    whole(2, n=n)
    return laplacian(n, np.arange(n - 1), np.arange(1, n))


def random_connectedGL(v: int, e: int) -> Real:  # noqa: N802
    """(v, v) the Laplacian of a random tree, each node on one before it, with up to ``e`` edges more."""
    whole(1, v=v)
    whole(0, e=e)
    later = np.arange(1, v)
    earlier = np.array([np.random.randint(0, node) for node in later], dtype=np.intp)  # noqa: NPY002
    tree = laplacian(v, earlier, later)
    return tree + _some(np.argwhere(np.triu(tree == 0.0, 1)), v, e)


def randomGL(v: int, e: int) -> Real:  # noqa: N802
    """(v, v) the Laplacian of ``e`` random edges, or of all where there are fewer; it may fall into parts."""
    whole(1, v=v)
    whole(0, e=e)
    return _some(np.argwhere(np.triu(np.ones((v, v)), 1)), v, e)


def delta_disk_neighbors(poses: Real, agent: int, delta: float) -> Index:
    """Who is within ``delta``, metres, of ``agent``, itself left out; poses (2 or more, N)."""
    places = np.asarray(poses, dtype=np.float64)[:2]
    _one_of(agent, places.shape[1])
    near = np.linalg.norm(places - places[:, agent : agent + 1], axis=0) <= delta
    near[agent] = False
    return np.flatnonzero(near)


def topological_neighbors(L: Real, agent: int) -> Index:  # noqa: N803
    """Who is joined with ``agent`` in the graph of the Laplacian (N, N), which is left as it was."""
    row = np.array(L)[agent] if _one_of(agent, len(L)) else np.empty(0)
    row[agent] = 0.0
    return np.flatnonzero(row)


def laplacian(n: int, first: Index, second: Index) -> Real:
    """(n, n) the Laplacian of the edges between ``first`` (m,) and ``second`` (m,), no edge given twice."""
    adjacent = np.zeros((n, n))
    adjacent[first, second] = adjacent[second, first] = 1.0
    return np.diag(adjacent.sum(axis=0)) - adjacent


def _some(candidates: Index, v: int, e: int) -> Real:
    """The Laplacian of ``e`` of the edges ``candidates`` (m, 2), or of all where there are fewer."""
    if min(e, len(candidates)) == 0:
        return np.zeros((v, v))
    np.random.shuffle(candidates)  # noqa: NPY002
    return laplacian(v, *candidates[:e].T)


def _one_of(agent: int, n: int) -> bool:
    if not 0 <= agent < n:
        raise ValueError(f"agent must be in 0..{n - 1}, got {agent}")
    return True
