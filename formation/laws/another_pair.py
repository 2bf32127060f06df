"""The angle law of followers that take another pair of earlier agents where one of their neighbours is not sensed.

For any two earlier agents m, l that p* does not put on one line with k, with w = (p*_k - p*_m) / (p*_l - p*_m) and a =
sin^2 of the angle at which k sees them,

    u_k = a [(1 - w) e_km + w e_kl]

is eq. (u) of the triangle (m, l, k). Its place of rest is that of every other pair, and all matrices are lower
triangular with a negative diagonal, so sum eps^(2k) |p~_k|^2 with a small eps falls under any switching between pairs:
global exponential stability, at the rate of the slowest pair that is used. A follower without any pair holds still.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.graph.edges import Index
from formation.laws.angle import AngleLaw
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.target import TargetFormation

SLOWEST = 0.05
"""1/s: pairs at which a follower would be slower are not used."""

MOST_PAIRS = 32
"""Pairs that a follower may fall back on, the fastest ones."""


class AnotherPairLaw(AngleLaw):
    """:class:`~formation.laws.angle.AngleLaw` with pairs to fall back on.

    Attributes:
        edges: (M, 2) rows (observer, observed) of what it measures: the graph's, then every other earlier agent.
    """

    def __init__(
        self, target: TargetFormation, first_follower: str = "stationary", own_gains: Real | None = None
    ) -> None:
        super().__init__(target, first_follower, own_gains)
        self._given = len(target.graph.edges)
        self.edges = with_earlier(target.graph.edges, target.graph.n)
        self._first, self._second, self._weights = _pairs(target, self.edges, own_gains)

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """As the angle law's, from relative positions (..., M, 2) along :attr:`edges`, NaN where an edge is lost."""
        u = super().__call__(relative[..., : self._given, :], compass, delta)
        missing = np.isnan(u[..., agents.FIRST_ORDINARY :, 0])
        if missing.any():
            other = as_vectors(self._fallback(as_complex(relative)))
            followers = u[..., agents.FIRST_ORDINARY :, :]
            u[..., agents.FIRST_ORDINARY :, :] = np.where(missing[..., None], other, followers)
        return u

    def _fallback(self, e: Complex) -> Complex:
        """(..., n - 2) what the first pair that is sensed makes of e (..., M); NaN where none is."""
        one, other = e[..., self._first], e[..., self._second]
        velocity = self._weights[..., 0] * one + self._weights[..., 1] * other
        sensed: NDArray[np.bool_] = ~np.isnan(velocity.real)
        best = sensed.argmax(axis=-1)[..., None]
        return np.take_along_axis(velocity, best, axis=-1)[..., 0]


def with_earlier(edges: Index, n: int) -> Index:
    """(M, 2) the edges (m, 2), then those from each agent to every earlier one that it does not sense yet."""
    sensed = {(k, i) for k, i in edges.tolist()}
    more = [(k, i) for k in range(agents.FIRST_ORDINARY, n) for i in range(k) if (k, i) not in sensed]
    return np.concatenate([edges, np.array(more, dtype=np.intp).reshape(-1, 2)])


def _pairs(target: TargetFormation, edges: Index, own_gains: Real | None) -> tuple[Index, Index, Complex]:
    """(n - 2, P) rows of the two edges of each follower's pairs, the fastest first, and their weights (n - 2, P, 2).

    A follower with fewer pairs has its first one again.
    """
    row = {(k, i): m for m, (k, i) in enumerate(edges.tolist())}
    p = as_complex(target.positions)
    chosen: list[list[tuple[int, int, complex, complex]]] = []
    for place, k in enumerate(target.graph.followers.tolist()):
        gain = 1.0 if own_gains is None else float(own_gains[place])
        found = []
        for i, j in combinations(range(k), 2):
            if p[i] == p[j] or p[k] in (p[i], p[j]):
                continue
            rate = float(np.imag((p[j] - p[k]) * np.conj(p[i] - p[k])) / (abs(p[j] - p[k]) * abs(p[i] - p[k]))) ** 2
            w = (p[k] - p[i]) / (p[j] - p[i])
            if rate >= SLOWEST:
                found.append((rate, row[k, i], row[k, j], gain * rate * (1.0 - w), gain * rate * w))
        i, j = target.graph.neighbours[place].tolist()
        own = (1.0, row[k, i], row[k, j], 0j, 0j)  # never asked where another one is sensed; keeps the table whole
        best = sorted(found, key=lambda pair: -pair[0])[:MOST_PAIRS] or [own]
        chosen.append([pair[1:] for pair in best])
    width = max(map(len, chosen))
    full = [pairs + pairs[:1] * (width - len(pairs)) for pairs in chosen]
    first = np.array([[pair[0] for pair in pairs] for pairs in full], dtype=np.intp)
    second = np.array([[pair[1] for pair in pairs] for pairs in full], dtype=np.intp)
    return first, second, np.array([[pair[2:] for pair in pairs] for pairs in full], dtype=np.complex128)
