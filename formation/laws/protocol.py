"""What every formation law is, and how it declares what it needs: the project's laws and a user's own alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from formation.measurements import RELATIVE_POSITION
from formation.plane import Real

LEADER_FIRST_FOLLOWER = "leader-first-follower"


class FormationLaw(Protocol):
    """The velocities of all agents at once, each from what that agent measures and in that agent's own frame.

    A law is a function: equal measurements give equal velocities, whatever was asked before. It may be asked several
    times in one control period. The common velocity v_r of a maneuver is not its business, the caller adds it.

    Besides ``needs_compass`` it may declare the attributes of :class:`Needs` that are not as there.
    """

    @property
    def needs_compass(self) -> bool:
        """Whether an agent needs the common x axis in its own frame."""

    def __call__(self, *measured_compass_delta: Any, **by_name: Any) -> Real:
        """Velocities (..., n, 2), m/s, each in its agent's own frame.

        Args:
            measured: one array for each kind of measurement that the law declares, in its order;
                :mod:`formation.measurements` has the shapes. Rows follow ``graph.edges``, or ``graph.corners``.
            compass: (..., n, 2) direction of the common x axis in each agent's frame; None unless
                :attr:`needs_compass`.
            delta: (2,) commanded displacement of agent 2 from agent 1, metres, in the common frame; None where the
                phase commands none.
        """


@dataclass(frozen=True)
class Needs:
    """What a law declares.

    Attributes:
        compass: whether an agent needs the common x axis in its own frame.
        handedness: whether all agents need one sense of rotation; None where the law does not say.
        measures: kinds of measurements, in the order in which it is called with them.
        graph: the condition on its sensing graph, a name of :data:`formation.graph.conditions.CONDITIONS`.
        communicates: what agents tell each other; empty for nothing.
    """

    compass: bool
    handedness: bool | None = None
    measures: tuple[str, ...] = (RELATIVE_POSITION,)
    graph: str = LEADER_FIRST_FOLLOWER
    communicates: str = ""


def needs(law: FormationLaw) -> Needs:
    """What a law declares, in its attributes ``needs_compass``, ``needs_handedness``, ``measures``, ``graph`` and
    ``communicates``; all but the first may be missing."""
    none = Needs(law.needs_compass)
    return Needs(
        law.needs_compass,
        getattr(law, "needs_handedness", none.handedness),
        tuple(getattr(law, "measures", none.measures)),
        getattr(law, "graph", none.graph),
        getattr(law, "communicates", none.communicates),
    )
