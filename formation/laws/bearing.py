"""Bearing laws: every agent turns the bearings that it measures to those of the target.

    u_k = -sum_i P(b_ki) b*_ki,   b = e / abs(e), P(b) = I - b b^T

Source      Zhao, Zelazo 2016 (zsy2016), undirected; Trinh et al. 2019 (LFF2019), leader-first-follower. Recalled; of
            LFF2019 the abstract of arXiv 2501.12355, which cites it, was seen
Graph       leader-first-follower; or every edge sensed from both its ends, the framework bearing rigid
Measures    bearings, with a compass
Proved      almost global convergence to the target's shape and orientation; undirected, centroid and scale are kept
Fails       with compass errors: directed, the formation is deformed and stands; undirected, it drifts for ever
"""

from __future__ import annotations

from typing import ClassVar

from formation.laws.base import ORIENTATION, SHAPE
from formation.laws.edge_sum import EdgeSum
from formation.laws.first_follower import align
from formation.measurements import BEARING


class BearingLaw(EdgeSum):
    """The law on a leader-first-follower graph: the leader stands still."""

    name = "bearing"
    sources = ("LFF2019",)
    measures = (BEARING,)
    needs_compass = True
    needs_handedness = True
    fixes = (SHAPE, ORIENTATION)
    steers = frozenset({ORIENTATION})
    edge_law = staticmethod(align)


class UndirectedBearingLaw(BearingLaw):
    """The law where every edge is sensed from both its ends."""

    name = "bearing-undirected"
    sources = ("zsy2016",)
    graph = "bearing rigid"
    leaders: ClassVar[int] = 0
