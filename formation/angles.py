"""Signed angles, named vertex first.

alpha(v; a, b) is the counter-clockwise angle in [0, 2 pi) that turns the ray v->a into the ray v->b. The paper defines
the middle index as the vertex but lists its experiment's angles vertex first; docs/paper.md gives the evidence.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from formation import agents
from formation.graph.sensing import Index, SensingGraph
from formation.plane import Real, as_complex

TURN = 2.0 * np.pi


def signed_angle(vertex: ArrayLike, a: ArrayLike, b: ArrayLike) -> Real:
    """alpha(vertex; a, b) in [0, 2 pi), radians, of points (..., 2) that broadcast (paper, Section 2.1).

    NaN where ``a`` or ``b`` coincides with the vertex: the angle does not exist there. An angle has the same bits alone
    and among others, which numpy's products of complex arrays have not.
    """
    v, p, q = (np.asarray(points, dtype=np.float64) for points in (vertex, a, b))
    ax, ay, bx, by = p[..., 0] - v[..., 0], p[..., 1] - v[..., 1], q[..., 0] - v[..., 0], q[..., 1] - v[..., 1]
    dot, cross = bx * ax + by * ay, by * ax - bx * ay
    angle = np.mod(np.arctan2(cross, dot), TURN)
    angle = np.where(angle >= TURN, 0.0, angle)  # mod of a tiny negative number rounds up to 2 pi itself
    return np.where((dot == 0.0) & (cross == 0.0), np.nan, angle)


def wrap(angle: ArrayLike) -> Real:
    """Wrap angles (radians, any shape) to (-pi, pi]."""
    return -(np.mod(np.pi - np.asarray(angle, dtype=np.float64), TURN) - np.pi)


@dataclass(frozen=True, eq=False)
class AngleSet:
    """Named signed angles alpha(v; a, b) of a framework (the paper's set A_Gf).

    Attributes:
        triples: (m, 3) rows (v, a, b) of array rows.

    Raises:
        ValueError: a triple does not name three distinct agents.
    """

    triples: Index

    def __post_init__(self) -> None:
        t = np.asarray(self.triples, dtype=np.intp).reshape(-1, 3)
        same = (t[:, 0] == t[:, 1]) | (t[:, 0] == t[:, 2]) | (t[:, 1] == t[:, 2])
        if (bad := np.flatnonzero(same)).size:
            raise ValueError(f"{angle_name(t[bad[0]])} does not name three distinct agents")
        if (bad := np.flatnonzero((t < 0).any(axis=1))).size:
            raise ValueError(f"{angle_name(t[bad[0]])} names an agent below 1")
        t.flags.writeable = False
        object.__setattr__(self, "triples", t)

    @classmethod
    def of_followers(cls, graph: SensingGraph) -> AngleSet:
        """Two angles that fix each triangle (i, j, k): alpha(j; i, k) and alpha(k; i, j)."""
        i, j, k = graph.triangles.T
        return cls(np.stack([np.stack([j, i, k], axis=1), np.stack([k, i, j], axis=1)], axis=1).reshape(-1, 3))

    @classmethod
    def of_places(cls, positions: ArrayLike) -> AngleSet:
        """Two angles of one triangle for each agent k = 3..n, with the two earlier agents i < j that make it roundest.

        They fix the shape of positions (n, 2) whatever the sensing graph is. Roundest: highest over
        its longest side, in shares of that side.
        """
        p = as_complex(positions)
        triples = []
        for k in range(agents.FIRST_ORDINARY, len(p)):
            i, j = np.triu_indices(k, k=1)
            sides = np.abs(np.stack([p[i] - p[j], p[i] - p[k], p[j] - p[k]]))
            area = np.abs(((p[i] - p[k]) * np.conj(p[j] - p[k])).imag)
            longest = np.maximum(sides.max(axis=0), np.finfo(float).tiny)
            best = int((area / longest**2).argmax())
            triples += [(j[best], i[best], k), (k, i[best], j[best])]
        return cls(np.array(triples))

    def __len__(self) -> int:
        return len(self.triples)

    @property
    def names(self) -> list[str]:
        """How each angle is written: ``"alpha(3;2,4)"``, agents by number."""
        return [angle_name(t) for t in self.triples]

    def measure(self, points: ArrayLike) -> Real:
        """The angles (..., m) in [0, 2 pi) of points (..., n, 2)."""
        p = np.asarray(points, dtype=np.float64)
        v, a, b = (np.take(p, self.triples[:, c], axis=-2) for c in range(3))
        return signed_angle(v, a, b)

    def errors(self, points: ArrayLike, targets: ArrayLike) -> Real:
        """Angle errors (..., m) in (-pi, pi] of points (..., n, 2) against target angles (m,), radians."""
        return wrap(self.measure(points) - np.asarray(targets, dtype=np.float64))


def angle_name(triple: Iterable[int]) -> str:
    """The written name of alpha(v; a, b) for array rows (v, a, b)."""
    v, a, b = (agents.number(row) for row in triple)
    return f"alpha({v};{a},{b})"
