"""Edge laws: what an agent makes of one relative position.

With e = p_2 - p_1, the position of the agent relative to its neighbour, and delta, the value that e should have, both
in the agent's own frame, each law gives a velocity. The paper uses them for the first follower, whose only edge leads
to the leader (Section 3.3). Summed over all edges they are the families of laws that its introduction weighs itself
against.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from formation.plane import Complex

BESIDE = 1e-6
"""Radians."""

EdgeLaw = Callable[[Complex, Complex], Complex]
"""Maps (e, delta) to a velocity: complex arrays (...) in one frame, metres to metres per second."""


def stationary(e: Complex, delta: Complex) -> Complex:
    """u = 0: the first follower holds its place and so fixes scale and orientation of the formation (Theorem 1)."""
    return np.zeros_like(e)


def displacement(e: Complex, delta: Complex) -> Complex:
    """u = -(e - delta), eq. (man); Ren, Beard, Atkins 2007; Oh, Park, Ahn 2015. Steers scale and orientation.

    The agent's frame must be aligned with the frame of ``delta``: a compass.
    """
    return delta - e


def distance(e: Complex, delta: Complex) -> Complex:
    """u = -(|e|^2 - |delta|^2) e, eq. (distance); Krick, Broucke, Francis 2009; Park, Oh, Ahn 2015. Steers the scale.

    Acts in any local frame, mirrored ones too: only the length of ``delta`` enters.
    """
    return -(np.abs(e) ** 2 - np.abs(delta) ** 2) * e


def bearing(e: Complex, delta: Complex) -> Complex:
    """u = P_b b*, b = e / |e|, b* = delta / |delta|, eq. (bearing); Zhao, Zelazo 2016; Trinh et al. 2019.

    Steers the orientation. Needs a compass. NaN while the two agents coincide: no bearing exists there.
    """
    return align(e / np.abs(e), delta)


def align(b: Complex, delta: Complex) -> Complex:
    """P_b b* from a bearing b: what a law makes of it whose agents measure no distances."""
    b_star = delta / np.abs(delta)
    return b_star - b * (np.conj(b) * b_star).real


def spiral(e: Complex, delta: Complex) -> Complex:
    """u = -e Log(e / delta). Steers scale and orientation; ours, not the paper's.

    Length and direction of e go their own ways, ln(|e| / |delta|) and the angle from delta each as e^{-t}: where the
    displacement law sends the first follower straight through the leader, and all others after it into one place, the
    formation turns, and is never smaller than it starts or ends. Near its end it is the displacement law. Needs a
    compass. From opposite to delta it turns clockwise; NaN while the two agents coincide.
    """
    return -e * logarithm(e / delta)


def logarithm(ratio: Complex) -> Complex:
    """Log with its cut :data:`BESIDE` the negative axis, so that rounding does not choose the way around."""
    return np.log(ratio * np.exp(-1j * BESIDE)) + 1j * BESIDE


EDGE_LAWS: Mapping[str, EdgeLaw] = MappingProxyType(
    {
        "stationary": stationary,
        "displacement": displacement,
        "distance": distance,
        "bearing": bearing,
        "spiral": spiral,
    }
)
"""The laws by the name that scenario files use."""

COMPASS_FREE = frozenset({"stationary", "distance"})
"""Laws that act in any local frame."""
