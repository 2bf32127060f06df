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
