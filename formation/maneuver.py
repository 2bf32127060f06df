"""Maneuvers: piecewise-constant velocity and displacement, and where they lead (paper, Section 3.3, Theorem 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formation import agents
from formation.plane import Real, as_complex, as_vectors


@dataclass(frozen=True)
class Phase:
    """One interval [t_{tau-1}, t_tau) of a maneuver.

    Attributes:
        name: what a person calls it.
        duration: seconds.
        velocity: v_r, m/s, in the common frame.
        delta: commanded displacement p_2 - p_1, metres, in the common frame; None for a stationary first follower.
    """

    name: str
    duration: float
    velocity: tuple[float, float] = (0.0, 0.0)
    delta: tuple[float, float] | None = None

    @property
    def displacement(self) -> complex | None:
        """``delta`` as a complex number."""
        return None if self.delta is None else complex(*self.delta)


def pair_ends(start: Real, phases: Sequence[Phase], first_follower: str) -> Real:
    """(P, 2, 2) where Theorem 2 puts agents 1 and 2 at the end of each phase, metres, once agent 2 has settled.

    The leader integrates v_r. The first follower keeps what its law does not steer: ``stationary`` the displacement,
    ``distance`` the bearing, ``bearing`` the distance.

    Args:
        start: (2, 2) initial positions of agents 1 and 2, metres.
        phases: the maneuver.
        first_follower: name of the first follower's law.
    """
    leader, first = as_complex(np.asarray(start)[: agents.FIRST_ORDINARY])
    e_12 = first - leader
    ends = []
    for phase in phases:
        leader = leader + complex(*phase.velocity) * phase.duration
        if phase.delta is not None:
            delta = complex(*phase.delta)
            e_12 = {
                "stationary": e_12,
                "displacement": delta,
                "distance": abs(delta) * e_12 / abs(e_12),
                "bearing": abs(e_12) * delta / abs(delta),
            }[first_follower]
        ends.append([leader, leader + e_12])
    return as_vectors(np.array(ends))
