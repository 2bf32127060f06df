"""A law as an audit asks it, and what an audit says."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formation import agents
from formation.analysis.linearisation import Linearisation, linearise
from formation.analysis.prediction import end_configuration
from formation.framework import Framework
from formation.graph.directed import Graph
from formation.graph.edges import Index
from formation.laws.protocol import FormationLaw, needs
from formation.measurements import EACH, perfect
from formation.plane import Complex, Real, as_complex, as_vectors

Measured = tuple[Real, ...]
"""One array for each kind of measurement that a law declares, in its order."""

PLACES = 5
"""Random configurations at which a property is looked for."""

SAME = 1e-9
"""Relative to the greatest speed: velocities that differ by less are the same but for rounding."""

REST = 1e-9
"""1/s, times the formation's size: slower agents are at rest."""

STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Of the differences that give the closed loop's derivative, relative to the shortest sensing edge.

The first that shows the law smooth is taken: a law may have a length of its own, far below the formation's.
"""


@dataclass(frozen=True)
class Finding:
    """One row of an audit.

    Attributes:
        check: what was looked at.
        holds: whether it is so; None for what is told and not demanded.
        measured: the number behind it; None where there is none.
        unit: of the number.
        remark: what it means; where it fails, which agent and which sensing edge, by number.
    """

    check: str
    holds: bool | None
    measured: float | None = None
    unit: str = ""
    remark: str = ""


@dataclass(frozen=True, eq=False)
class Subject:
    """A law with all that is needed to ask it.

    Attributes:
        law: what is audited.
        target: the target formation.
        delta: commanded displacement of agent 2 from agent 1, metres; None where the law is told none.
    """

    law: FormationLaw
    target: Framework
    delta: tuple[float, float] | None = None

    @property
    def graph(self) -> Graph:
        return self.target.graph

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of measurements that the law declares."""
        return needs(self.law).measures

    @cached_property
    def positions(self) -> Real:
        """(n, 2) the target's shape as p* has it, or where agent 2 has its commanded displacement, metres."""
        p = self.target.positions
        if self.delta is None:
            return p
        return end_configuration(self.target, p[agents.LEADER], p[agents.LEADER] + self.delta)

    @cached_property
    def size(self) -> float:
        """Root mean square distance of the agents from their centre, metres."""
        return float(np.sqrt(((self.positions - self.positions.mean(axis=0)) ** 2).sum(axis=1).mean()))

    def places(self, rng: np.random.Generator) -> Real:
        """(:data:`PLACES`, n, 2) random configurations about the target, metres."""
        return self.positions + rng.normal(0.0, self.size, (PLACES, *self.positions.shape))

    def measure(
        self, points: Real, frames: Complex | None = None, mirrored: bool = False
    ) -> tuple[Measured, Real | None]:
        """What the agents at points (..., n, 2), metres, measure, and the compass if it is needed.

        ``frames`` (n,) are the x axes of the agents' frames, unit complex numbers; the common frame where absent.
        """
        observer, observed = self.graph.edges.T
        p = as_complex(points)
        turn = np.ones(self.graph.n, dtype=np.complex128) if frames is None else np.conj(frames)
        relative = (p[..., observed] - p[..., observer]) * turn[observer]
        compass = np.broadcast_to(turn, p.shape)
        if mirrored:
            relative, compass = np.conj(relative), np.conj(compass)
        measured = perfect(self.kinds, as_vectors(relative), self.graph.corners)
        return measured, as_vectors(compass) if self.law.needs_compass else None

    def observers(self, kind: str) -> Index:
        """Who measures each row of a kind of measurement."""
        edges = self.graph.edges[:, 0]
        return edges if EACH[kind] == "edge" else edges[self.graph.corners[:, 0]]

    def ask(self, measured: Measured, compass: Real | None) -> Real:
        """The law's velocities (..., n, 2), m/s, each in its agent's own frame."""
        return np.array(self.law(*measured, compass, None if self.delta is None else np.array(self.delta)))

    def __call__(self, points: Real, frames: Complex | None = None, mirrored: bool = False) -> Real:
        """Velocities (n, 2), m/s, in the common frame, of agents at points (n, 2), metres, each in its frame."""
        u = as_complex(self.ask(*self.measure(points, frames, mirrored)))
        if mirrored:
            u = np.conj(u)
        return as_vectors(u if frames is None else u * frames)

    def speed(self, points: Real) -> Real:
        """(n,) speeds, m/s, at points (n, 2), metres."""
        return np.linalg.norm(self(points), axis=-1)

    def who(self, row: int) -> str:
        """The agent in a row, with its sensing edges: ``agent 3, edges (3, 1) (3, 2)``."""
        edges = [f" ({k}, {i})" for k, i in agents.numbers(self.graph.edges).tolist() if k == agents.number(row)]
        return f"{agents.name(row)}, edge{'s' * (len(edges) > 1)}{''.join(edges)}" if edges else agents.name(row)

    @cached_property
    def loop(self) -> Linearisation:
        """The closed loop at the target."""
        observer, observed = self.graph.edges.T
        shortest = float(np.linalg.norm(self.positions[observed] - self.positions[observer], axis=1).min())
        for step in STEPS:
            loop = linearise(self, self.positions, step * shortest)
            if loop.smooth:
                break
        return loop
