"""The families of laws that the paper's introduction weighs itself against, on the same sensing graph.

Each agent drives what it measures to the displacements, bearings or distances of p*, one edge law per sensing edge; the
leader stands still. What each family needs beyond relative positions in a local frame, and what it fixes:

- ``displacement`` needs a compass; the shape is reached with the scale and the orientation of p*.
- ``bearing`` needs a compass; the shape is reached with the orientation of p* and the scale of agents 1 and 2.
- ``distance`` needs nothing; but its equilibria include mirrored triangles and collinear places, so that some starts
  end in a wrong shape for ever.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.laws.first_follower import COMPASS_FREE, EDGE_LAWS
from formation.plane import Real, as_complex, as_vectors
from formation.target import TargetFormation

FAMILIES = ("displacement", "bearing", "distance")
"""The families by the name that scenario files use."""


class ComparisonLaw:
    """u_k = sum over the neighbours i of k of the family's edge law of (p_k - p_i, p*_k - p*_i).

    Attributes:
        needs_compass: whether an agent needs the common x axis in its own frame.

    Raises:
        ValueError: ``family`` is not one of :data:`FAMILIES`.
    """

    def __init__(self, target: TargetFormation, family: str) -> None:
        if family not in FAMILIES:
            raise ValueError(f"family must be one of {', '.join(FAMILIES)}, got {family!r}")
        observer, observed = target.graph.edges.T
        p = as_complex(target.positions)
        self.needs_compass = family not in COMPASS_FREE
        self._edge_law = EDGE_LAWS[family]
        self._observer = observer
        self._desired = p[observer] - p[observed]
        self._n = target.graph.n

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, from relative positions (..., 2n - 3, 2); arguments as for the angle law.

        ``delta``, the commanded displacement of the first follower, is not used: these laws take theirs from p*.
        """
        desired = self._desired
        if self.needs_compass:
            if compass is None:
                raise ValueError("compass is missing: the law needs it")
            desired = desired * as_complex(compass)[..., self._observer]
        v = self._edge_law(-as_complex(relative), desired)
        u = np.zeros((*v.shape[:-1], self._n), dtype=np.complex128)
        u[..., agents.FIRST_FOLLOWER] = v[..., 0]
        pairs = v[..., 1:].reshape(*v.shape[:-1], -1, 2)
        np.add(pairs[..., 0], pairs[..., 1], out=u[..., agents.FIRST_ORDINARY :])
        return as_vectors(u)
