"""What every formation law is: the paper's, those that it is compared with, and a user's own."""

from __future__ import annotations

from typing import Protocol

from formation.plane import Real


class FormationLaw(Protocol):
    """The velocities of all agents at once, each from what that agent measures and in that agent's own frame.

    A law is a function: equal measurements give equal velocities, whatever was asked before. It may be asked several
    times in one control period. The common velocity v_r of a maneuver is not its business, the caller adds it.
    """

    @property
    def needs_compass(self) -> bool:
        """Whether an agent needs the common x axis in its own frame."""

    def __call__(self, relative: Real, compass: Real | None = None, delta: Real | None = None) -> Real:
        """Velocities (..., n, 2), m/s, each in its agent's own frame.

        Args:
            relative: (..., 2n - 3, 2) relative positions, metres, each in its observer's frame, in the row order of
                :attr:`SensingGraph.edges`.
            compass: (..., n, 2) direction of the common x axis in each agent's frame; None unless
                :attr:`needs_compass`.
            delta: (2,) commanded displacement of agent 2 from agent 1, metres, in the common frame; None where the
                phase commands none.
        """
