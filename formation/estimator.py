"""The reference velocity when only the leader knows it (paper, Section 3.3).

Every other agent keeps an estimate of v_r and moves it towards the mean of the estimates that it hears. Over one period
of length h the estimate covers the fraction 1 - exp(-kappa h) of the way, a convex combination, so the protocol is
stable for every gain kappa, period and graph. All estimates reach v_r if and only if the communication graph has a
spanning tree rooted at the leader.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formation import agents
from formation.graph.sensing import Index
from formation.plane import Real


class VelocityEstimator:
    """Estimates of v_r by consensus on a communication graph.

    Attributes:
        edges: (m, 2) as given.

    Args:
        n: number of agents.
        edges: (m, 2) rows (receiver, sender).
        gain: kappa, 1/s.

    Raises:
        ValueError: an edge names no agent, the gain is not positive, or agents cannot hear from the leader, directly
            or through others; the message names them.
    """

    def __init__(self, n: int, edges: ArrayLike, gain: float) -> None:
        e = np.asarray(edges, dtype=np.intp).reshape(-1, 2)
        if not (np.isfinite(gain) and gain > 0.0):
            raise ValueError(f"gain must be a positive number of 1/s, got {gain}")
        if (bad := np.flatnonzero(((e < 0) | (e >= n)).any(axis=1))).size:
            receiver, sender = agents.numbers(e[bad[0]])
            raise ValueError(f"communication edge ({receiver}, {sender}) names an agent outside 1..{n}")
        if (lost := unreachable(n, e)).size:
            named = ", ".join(str(agents.number(row)) for row in lost)
            raise ValueError(
                "the communication graph has no spanning tree rooted at the leader: "
                f"{'agent' if lost.size == 1 else 'agents'} {named} cannot hear from it"
            )
        self.edges = e
        weights = np.zeros((n, n))
        weights[e[:, 0], e[:, 1]] = 1.0
        weights[agents.LEADER] = 0.0
        weights[agents.LEADER, agents.LEADER] = 1.0
        self._mean = weights / weights.sum(axis=1, keepdims=True)
        self._gain = gain

    def share(self, period: float) -> float:
        """Of the way to the mean that it hears, what an estimate covers in one period, seconds."""
        return 1.0 - float(np.exp(-self._gain * period))

    def step(self, estimates: Real, velocity: ArrayLike, period: float, heard: NDArray[np.bool_] | None = None) -> Real:
        """The estimates (..., n, 2), m/s, one period (seconds) later, while the leader holds ``velocity`` (2,).

        ``heard`` (..., m) is which messages arrive along :attr:`edges`; all where absent. Who hears nobody keeps its
        estimate.
        """
        known = estimates.copy()
        known[..., agents.LEADER, :] = velocity
        mean = self._mean if heard is None else self._mean_of(heard)
        return known + self.share(period) * (mean @ known - known)

    def _mean_of(self, heard: NDArray[np.bool_]) -> Real:
        """(..., n, n) rows that average what each agent hears, or keep its own where it hears nobody."""
        weights = np.zeros((*heard.shape[:-1], *self._mean.shape))
        weights[..., self.edges[:, 0], self.edges[:, 1]] = heard
        weights[..., agents.LEADER, :] = 0.0
        count = weights.sum(axis=-1, keepdims=True)
        alone = count == 0.0
        mean: Real = (weights + alone * np.eye(len(self._mean))) / np.where(alone, 1.0, count)
        return mean


def unreachable(n: int, edges: Index) -> Index:
    """Rows of the agents that no chain of communication edges (receiver, sender) connects to the leader."""
    heard = np.zeros(n, dtype=bool)
    heard[agents.LEADER] = True
    while True:
        news = edges[heard[edges[:, 1]] & ~heard[edges[:, 0]], 0]
        if not news.size:
            return np.flatnonzero(~heard)
        heard[news] = True
