"""A framework (G, p*): a sensing graph of any kind with one configuration that has the wanted shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formation import agents
from formation.graph.directed import Graph
from formation.plane import Real


@dataclass(frozen=True, eq=False)
class Framework:
    """What a law is made for: who senses whom, and the shape.

    Attributes:
        graph: the sensing graph.
        positions: (n, 2) a configuration p*, metres.

    Raises:
        ValueError: wrong shape, a number that is not finite, or agents 1 and 2 in one place.
    """

    graph: Graph
    positions: Real

    def __post_init__(self) -> None:
        p = np.array(self.positions, dtype=np.float64)
        if p.shape != (self.graph.n, 2):
            raise ValueError(f"target positions must have the shape ({self.graph.n}, 2), got {p.shape}")
        if (bad := np.flatnonzero(~np.isfinite(p).all(axis=1))).size:
            raise ValueError(f"target position of {agents.name(bad[0])} is not finite: {p[bad[0]].tolist()}")
        if (p[agents.LEADER] == p[agents.FIRST_FOLLOWER]).all():
            raise ValueError(
                f"leader and first follower coincide in the target at {p[agents.LEADER].tolist()}, "
                "their distance fixes the scale and must not be 0"
            )
        p.flags.writeable = False
        object.__setattr__(self, "positions", p)
