"""Sequential activation (paper, Lemma 3): each follower starts when its two neighbours have stabilized.

A follower knows how far it is from the place that its neighbours give it: |u_k| / sin^2(a_k), from its own two
measurements. It counts as settled when that distance is below a tolerance and its neighbours have settled, and it tells
its followers so: one bit along each sensing edge, the only communication.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from formation import agents
from formation.analysis.prediction import decay_rates
from formation.plane import Real
from formation.target import TargetFormation


class SequentialActivation:
    """Which agents may move, for one run or a batch of runs. An agent that has started never stops.

    Attributes:
        active: (..., n) which agents may move now. The leader and the first follower always may.
    """

    def __init__(
        self,
        target: TargetFormation,
        tolerance: float,
        batch: tuple[int, ...] = (),
        own_gains: Real | None = None,
    ) -> None:
        self._rates = decay_rates(target) if own_gains is None else decay_rates(target) * own_gains
        self._i, self._j = target.graph.neighbours.T
        self._tolerance = tolerance
        self._settled = np.zeros((*batch, target.graph.n), dtype=bool)
        self._settled[..., : agents.FIRST_ORDINARY] = True
        self.active = self._settled.copy()
        self._activate()

    def update(self, velocity: Real) -> None:
        """Take the law's velocities (..., n, 2), m/s, without v_r, of all agents, active or not, at one instant."""
        distance = np.hypot(velocity[..., 0], velocity[..., 1])[..., agents.FIRST_ORDINARY :] / self._rates
        arrived = self.active[..., agents.FIRST_ORDINARY :] & (distance < self._tolerance)
        self._settled[..., agents.FIRST_ORDINARY :] |= arrived
        self._activate()

    def _activate(self) -> None:
        ready = self._settled[..., self._i] & self._settled[..., self._j]
        self.active[..., agents.FIRST_ORDINARY :] |= ready


def collision_margins(target: TargetFormation, start: Real, end: Real) -> Real:
    """(n - 2,) margin of the collision-free condition, eq. (c3), metres; the lemma holds for followers above 0.

        min(|p*_k - p*_i|, |p*_k - p*_j|) - |p_k(0) - p*_k|

    While neighbours stand at their places, follower k never comes closer to either than this margin.

    Args:
        target: the target formation.
        start: (n, 2) initial positions, metres.
        end: (n, 2) the predicted end configuration p*, metres.
    """
    i, j, k = target.graph.triangles.T
    reach = np.minimum(np.linalg.norm(end[k] - end[i], axis=-1), np.linalg.norm(end[k] - end[j], axis=-1))
    margins: NDArray[np.float64] = reach - np.linalg.norm(start[k] - end[k], axis=-1)
    return margins
