"""One event of a run: what happens, to whom, from when until when, and how people read of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.obstacles import Obstacle
from scenarios.definition.schema import EventTable

STOP, PUSH, DROPOUT, EDGE_LOSS = "stop", "push", "dropout", "edge-loss"
SENSOR, MESSAGE_LOSS, RESHAPE, OBSTACLE = "sensor", "message-loss", "reshape", "obstacle"

AT_ONCE = (PUSH, RESHAPE)
"""Kinds that are over when they have happened."""

SAME_TIME = 1e-6
"""Seconds: times that differ by less are one."""


@dataclass(frozen=True, eq=False)
class Event:
    """Something that happens in a run.

    Attributes:
        number: its place in the scenario, from 1.
        kind: a name of this module.
        begin: seconds since the start of the run.
        end: when it is over; infinite where it never is, ``begin`` where it is over at once.
        table: its keys.
        what: a sentence about its begin, without a full stop.
        over: a sentence about its end; empty where it has none.
        row: of the agent; None where it is about no agent.
        pair: rows (observer, observed) of the edge; None where it is about no edge.
        obstacle: what appears; None where nothing does.
    """

    number: int
    kind: str
    begin: float
    end: float
    table: EventTable
    what: str
    over: str = ""
    row: int | None = None
    pair: tuple[int, int] | None = None
    obstacle: Obstacle | None = None

    @property
    def subject(self) -> tuple[str, object]:
        """What two events at one time must not share."""
        return self.kind, self.pair if self.row is None else self.row

    def lasts(self, t: float) -> bool:
        """Whether it is on at a time, seconds."""
        return self.begin - SAME_TIME <= t < self.end - SAME_TIME

    def happens(self, t: float) -> bool:
        """Whether it begins at a time, seconds."""
        return abs(self.begin - t) <= SAME_TIME

    @property
    def boundaries(self) -> tuple[float, ...]:
        """The times at which something changes, seconds."""
        return (self.begin, self.end) if self.begin < self.end < np.inf else (self.begin,)
