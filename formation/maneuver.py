"""Maneuvers: phases of constant or changing velocity and displacement, and where they lead (Section 3.3, Theorem 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formation import agents
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.references.protocol import Reference, pair_displacement


@dataclass(frozen=True)
class Phase:
    """One interval [t_{tau-1}, t_tau) of a maneuver.

    Attributes:
        name: what a person calls it.
        duration: seconds.
        velocity: v_r, m/s, in the common frame.
        delta: commanded displacement p_2 - p_1, metres, in the common frame; None for a stationary first follower.
        reference: how both change during the phase, from these at its begin; None where they are constant.
    """

    name: str
    duration: float
    velocity: tuple[float, float] = (0.0, 0.0)
    delta: tuple[float, float] | None = None
    reference: Reference | None = None

    @property
    def displacement(self) -> complex | None:
        """``delta`` as a complex number."""
        return None if self.delta is None else complex(*self.delta)

    @property
    def moving(self) -> bool:
        """Whether the leader ever moves."""
        return any(self.velocity) or self.reference is not None

    @property
    def bends(self) -> list[float]:
        """Seconds into the phase at which its reference, if it has one, is not smooth."""
        return [] if self.reference is None else self.reference.bends.tolist()


def pair_ends(start: Real, phases: Sequence[Phase], first_follower: str, feedforward: bool = False) -> Real:
    """(P, 2, 2) where Theorem 2 puts agents 1 and 2 at the end of each phase, metres, once agent 2 has settled.

    The leader integrates v_r. The first follower keeps what its law does not steer: ``stationary`` the displacement,
    ``distance`` the bearing, ``bearing`` the distance.

    Args:
        start: (2, 2) initial positions of agents 1 and 2, metres.
        phases: the maneuver.
        first_follower: name of the first follower's law.
        feedforward: whether agents are told how the formation scales and turns.
    """
    leader, first = as_complex(np.asarray(start)[: agents.FIRST_ORDINARY])
    e_12 = first - leader
    ends = []
    for phase in phases:
        if phase.reference is not None:
            first = leader + e_12
            leader, first = pair_places((leader, first), phase, first_follower, feedforward, np.array(phase.duration))
            e_12 = first - leader
            ends.append([leader, first])
            continue
        leader = leader + complex(*phase.velocity) * phase.duration
        if phase.delta is not None:
            delta = complex(*phase.delta)
            e_12 = {
                "stationary": e_12,
                "displacement": delta,
                "spiral": delta,
                "distance": abs(delta) * e_12 / abs(e_12),
                "bearing": abs(e_12) * delta / abs(delta),
            }[first_follower]
        ends.append([leader, leader + e_12])
    return as_vectors(np.array(ends))


def pair_places(
    start: tuple[Complex, Complex], phase: Phase, first_follower: str, feedforward: bool, t: Real
) -> tuple[Complex, Complex]:
    """(...) complex places of agents 1 and 2 at times t (...), seconds into a phase with a reference, without lag.

    Args:
        start: of agents 1 and 2 at the phase's begin, complex metres.
        phase: with a reference.
        first_follower: name of the first follower's law.
        feedforward: whether agents are told how the formation scales and turns.
        t: seconds since the phase's begin.
    """
    if phase.reference is None:
        raise ValueError(f"phase {phase.name} has no reference")
    leader = start[0] + phase.reference.path(t)
    e_12 = complex(start[1] - start[0])
    return leader, leader + pair_displacement(phase.reference, e_12, phase.displacement, first_follower, feedforward, t)
