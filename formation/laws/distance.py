"""Distance laws: every agent moves along what it measures until the target's distances are reached.

    u_k = -sum_i (abs(e_ki)^2 - d_ki^2) e_ki,   d_ki = abs(p*_k - p*_i)

Source      Krick, Broucke, Francis 2009; Anderson, Yu, Fidan, Hendrickx 2008 (Anderson, An2008); Park, Jeong, Ahn 2015
            (park2015). Recalled, not checked against the texts
Graph       leader-first-follower; or every edge sensed from both its ends, the framework rigid, and then the law is
            the negative gradient of 1/4 sum over the edges of (abs(e)^2 - d^2)^2
Measures    relative positions in any local frame, mirrored ones too
Proved      local exponential convergence; almost global for a triangle and for a tree
Fails       mirrored triangles, and more: most random starts end in a wrong shape
"""

from __future__ import annotations

from typing import ClassVar

from formation.laws.base import SCALE, SHAPE
from formation.laws.edge_sum import EdgeSum
from formation.laws.first_follower import distance


class DistanceLaw(EdgeSum):
    """The law on a leader-first-follower graph: the leader stands still."""

    name = "distance"
    sources: ClassVar[tuple[str, ...]] = ("park2015",)
    fixes = (SHAPE, SCALE)
    steers = frozenset({SCALE})
    edge_law = staticmethod(distance)


class UndirectedDistanceLaw(DistanceLaw):
    """The gradient law."""

    name = "distance-undirected"
    sources = ("An2008", "Anderson", "park2015")
    graph = "rigid"
    leaders: ClassVar[int] = 0
