"""What a law may ask its agents to measure, by name.

A law declares kinds in ``measures`` and is called with one array for each, in that order; it gets nothing else. Two of
the kinds belong to edges, two to *corners*, the pairs of edges that share an observer (``graph.corners``).

| kind | array | what it is |
|---|---|---|
| ``relative position`` | (..., m, 2) | e = p_i - p_k along each edge, metres, in the observer's frame |
| ``bearing`` | (..., m, 2) | e / abs(e), in the observer's frame |
| ``distance`` | (..., m) | abs(e), metres |
| ``angle`` | (..., c) | counter-clockwise from the corner's first edge to its second, radians in [0, 2 pi) |
| ``ratio`` | (..., c) | length of the corner's second edge over that of its first |
"""

from __future__ import annotations

from collections.abc import Iterable
from types import MappingProxyType

import numpy as np

from formation.graph.edges import Index
from formation.plane import Real, as_complex, as_vectors

RELATIVE_POSITION, BEARING, DISTANCE, ANGLE, RATIO = "relative position", "bearing", "distance", "angle", "ratio"

KINDS = MappingProxyType({RELATIVE_POSITION: 2, BEARING: 2, DISTANCE: 1, ANGLE: 1, RATIO: 1})
"""Each kind with the number of dimensions that its array has after the batch."""

EACH = MappingProxyType(
    {RELATIVE_POSITION: "edge", BEARING: "edge", DISTANCE: "edge", ANGLE: "corner", RATIO: "corner"}
)
"""What each row of a kind belongs to."""


def perfect(kinds: Iterable[str], relative: Real, corners: Index) -> tuple[Real, ...]:
    """The kinds of measurements that relative positions (..., m, 2), metres, amount to, without noise."""
    e = as_complex(relative)
    first, second = e[..., corners[:, 0]], e[..., corners[:, 1]]

    def one(kind: str) -> Real:
        match kind:
            case "relative position":
                return relative
            case "bearing":
                return as_vectors(e / np.abs(e))
            case "distance":
                return np.abs(e)
            case "angle":
                return np.mod(np.angle(second * np.conj(first)), 2.0 * np.pi)
            case "ratio":
                return np.abs(second) / np.abs(first)
        raise ValueError(f"measures must be among {', '.join(KINDS)}, got {kind!r}")

    return tuple(one(kind) for kind in kinds)
