"""Laws that are sums of one edge law over an agent's edges."""

from __future__ import annotations

from abc import abstractmethod

from formation.laws.base import Law
from formation.plane import Complex, Real, as_complex, as_vectors


class EdgeSum(Law):
    """u_k = sum over the edges (k, i) of the edge law of (p_k - p_i, p*_k - p*_i), on any graph.

    On a leader-first-follower graph the leader senses nobody and stands still.
    """

    @staticmethod
    @abstractmethod
    def edge_law(e: Complex, delta: Complex, /) -> Complex:
        """One of :mod:`formation.laws.first_follower`."""

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions or bearings (..., m, 2).

        Raises:
            ValueError: the compass is missing.
        """
        desired = self._wanted(compass, delta)
        return as_vectors(self._by_agent(self.edge_law(-as_complex(relative), desired)))

    def _wanted(self, compass: Real | None, delta: Real | None) -> Complex:
        """What each edge should be; in the observers' frames with a compass."""
        desired = self._scaled(delta)
        if not self.needs_compass:
            return desired
        if compass is None:
            raise ValueError("compass is missing: the law needs it")
        return desired * as_complex(compass)[..., self._observer]
