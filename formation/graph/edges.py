"""Lists of directed edges (observer, observed): what all graph types share."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from formation import agents

Index = NDArray[np.intp]


def corners(edges: Index) -> Index:
    """(c, 2) pairs a < b of rows of ``edges`` (m, 2), sorted by observer, that share their observer; in that order."""
    start, pairs = 0, []
    for count in np.bincount(edges[:, 0]).tolist() if len(edges) else []:
        first, second = np.triu_indices(count, k=1)
        pairs.append(np.stack([first, second], axis=1) + start)
        start += count
    return np.concatenate([np.empty((0, 2), dtype=np.intp), *pairs]).astype(np.intp)


def edge_name(edge: Iterable[int]) -> str:
    """How messages name an edge given by rows: ``(3, 1)``, agents by number."""
    k, i = (agents.number(row) for row in edge)
    return f"({k}, {i})"


def triangles(edges: Index) -> Index:
    """(t, 3) agents i < j < k that all sense each other."""
    known = {(k, i) for k, i in edges.tolist()}
    mutual = sorted((k, i) for k, i in known if k < i and (i, k) in known)
    found = [(i, j, k) for i, j in mutual for other, k in mutual if other == j and (i, k) in known and (k, i) in known]
    return np.array(found, dtype=np.intp).reshape(-1, 3)


def rows_of(edges: Index, wanted: Index) -> Index:
    """The rows of ``edges`` (m, 2) that hold the edges ``wanted`` (..., 2).

    Raises:
        ValueError: one is not there; the message names it.
    """
    place = {(k, i): row for row, (k, i) in enumerate(edges.tolist())}
    flat = np.asarray(wanted, dtype=np.intp).reshape(-1, 2).tolist()
    if missing := [edge for edge in flat if tuple(edge) not in place]:
        raise ValueError(f"edge {edge_name(missing[0])} is missing")
    return np.array([place[k, i] for k, i in flat], dtype=np.intp).reshape(np.shape(wanted)[:-1])
