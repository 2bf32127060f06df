"""What the project's own laws have in common: they declare, in class attributes, what :class:`Needs` lists and more."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from formation import agents
from formation.framework import Framework
from formation.laws.protocol import LEADER_FIRST_FOLLOWER
from formation.measurements import RELATIVE_POSITION
from formation.plane import Complex, Real, as_complex

SHAPE, SCALE, ORIENTATION = "shape", "scale", "orientation"


class Law(ABC):
    """A law of the literature.

    Attributes:
        name: as scenario files write it.
        sources: keys of the paper's bibliography that it stands for.
        graph, measures, needs_compass, needs_handedness, communicates: see :class:`formation.laws.protocol.Needs`.
        fixes: what the formation has in the end of the target's shape, scale and orientation.
        steers: what of a commanded displacement delta of agent 2 from agent 1 the formation follows.
        leaders: how many of the agents 1, 2, ... stand still unless they are commanded.
    """

    name: ClassVar[str]
    sources: ClassVar[tuple[str, ...]] = ()
    graph: ClassVar[str] = LEADER_FIRST_FOLLOWER
    measures: ClassVar[tuple[str, ...]] = (RELATIVE_POSITION,)
    needs_compass = False
    needs_handedness: ClassVar[bool] = False
    communicates: ClassVar[str] = ""
    fixes: ClassVar[tuple[str, ...]] = (SHAPE,)
    steers: ClassVar[frozenset[str]] = frozenset()
    leaders: ClassVar[int] = 1

    def __init__(self, formation: Framework) -> None:
        self._n = formation.graph.n
        self._observer, self._observed = formation.graph.edges.T
        self._places = as_complex(formation.positions)
        self._desired = self._places[self._observer] - self._places[self._observed]
        self._seeing, self._first_rows = np.unique(self._observer, return_index=True)

    @abstractmethod
    def __call__(self, *measured_compass_delta: Any, **by_name: Any) -> Real:
        """Velocities (..., n, 2), m/s; see :class:`formation.laws.protocol.FormationLaw`."""

    def _by_agent(self, terms: Complex) -> Complex:
        """The sum (..., n) of terms (..., m) of edges over each agent's own edges; 0 where it senses nobody."""
        u = np.zeros((*terms.shape[:-1], self._n), dtype=np.complex128)
        if self._seeing.size:
            u[..., self._seeing] = np.add.reduceat(terms, self._first_rows, axis=-1)
        return u

    def _scaled(self, delta: Real | None) -> Complex:
        """(..., m) p*_k - p*_i of each edge, scaled and turned by delta / (p*_2 - p*_1) where there is a command."""
        own = self._places[agents.FIRST_FOLLOWER] - self._places[agents.LEADER]
        if delta is None:
            return self._desired
        commanded = as_complex(delta)
        return self._desired * np.where(commanded == own, 1.0, commanded / own)[..., None]
