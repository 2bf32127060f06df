"""Who does what it should not, and what is not sensed: the state of the events at one time, for the controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robots.instruments import Disturbance, Instruments
from robots.own_motion import Sensed
from scenarios.definition.events.event import DROPOUT, EDGE_LOSS, MESSAGE_LOSS, OBSTACLE, PUSH, SENSOR, STOP, Event
from scenarios.definition.experiment import Experiment
from scenarios.definition.parts.machines import imperfections
from scenarios.definition.schema import SensorTable
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Outages:
    """What is so from one event to the next.

    Attributes:
        stopped: (n,) which robots stand still; None where none does.
        gone: (m,) which edges give nothing because of an event; None where all may give something.
        sensor: what the sensors are like.
        message_loss: probability that a message is lost.
    """

    stopped: Flags | None
    gone: Flags | None
    sensor: SensorTable
    message_loss: float

    @property
    def blind(self) -> bool:
        """Whether anything but chance keeps a robot from a measurement."""
        sensor = self.sensor
        return self.gone is not None or sensor.sensing_range_m is not None or sensor.field_of_view_deg is not None

    @classmethod
    def at(cls, experiment: Experiment, t: float, index: int) -> Outages:
        """Those at a time, seconds, in the phase with an index."""
        on = [event for event in experiment.events if event.lasts(t)]
        rows = [event.row for event in on if event.kind == STOP and event.row is not None]
        lost = lost_edges(experiment, t, index)
        sensor, message_loss = experiment.scenario.sensor, experiment.scenario.communication.message_loss
        for event in on:
            if event.kind == SENSOR:
                keys = ("sensing_range_m", "field_of_view_deg", "edge_loss", "dropout")
                new = {key: value for key in keys if (value := getattr(event.table, key)) is not None}
                sensor = sensor.model_copy(update=new)
            elif event.kind == MESSAGE_LOSS and event.table.message_loss is not None:
                message_loss = event.table.message_loss
        return cls(
            stopped=np.isin(np.arange(experiment.n), rows) if rows else None,
            gone=lost if lost.any() else None,
            sensor=sensor,
            message_loss=message_loss,
        )

    def instruments(self, given: Instruments, before: SensorTable) -> Instruments:
        """What the robots carry, given what they would carry without events, with sensors as in a table."""
        changed = self.sensor.edge_loss != before.edge_loss or self.sensor.dropout != before.dropout
        return given.having(imperfections(self.sensor)) if changed else given

    def disturb(self, drawn: Disturbance | None, instruments: Instruments, sensed: Sensed) -> Disturbance | None:
        """One period's disturbance, with what no sensor reaches added to what it has lost already."""
        lost = self._unseen(instruments, sensed)
        if lost is None:
            return drawn
        had = drawn or Disturbance()
        also = lost if had.lost is None else had.lost | lost
        return replace(had, lost=also)

    def _unseen(self, instruments: Instruments, sensed: Sensed) -> Flags | None:
        """(..., m) edges that are lost, or longer than the sensing range, or outside the field of view."""
        reach, view = self.sensor.sensing_range_m, self.sensor.field_of_view_deg
        if reach is None and view is None:
            return self.gone
        e = instruments.measure(sensed.others, sensed.headings, sensed.own).view(np.complex128)[..., 0]
        unseen = np.zeros(e.shape, dtype=bool) if self.gone is None else np.broadcast_to(self.gone, e.shape).copy()
        if reach is not None:
            unseen |= np.abs(e) > reach
        if view is not None:
            unseen |= np.abs(np.angle(e)) > np.radians(view) / 2.0
        return unseen


def lost_edges(experiment: Experiment, t: float, index: int) -> Flags:
    """(m,) which edges give nothing at a time, seconds, in a phase, because of an event; edges of its instruments."""
    observer, observed = experiment.of_phase(index).instruments.edges.T
    lost = np.zeros(len(observer), dtype=bool)
    for event in experiment.events:
        if not event.lasts(t):
            continue
        if event.kind == DROPOUT:
            lost |= observed == event.row
        elif event.kind == EDGE_LOSS and event.pair is not None:
            lost |= (observer == event.pair[0]) & (observed == event.pair[1])
    return lost


def pushes(experiment: Experiment, t: float) -> Real | None:
    """(n, 2) how far robots are pushed at a time, seconds, metres; None where none is."""
    found = [event for event in experiment.events if event.kind == PUSH and event.happens(t)]
    if not found:
        return None
    way = np.zeros((experiment.n, 2))
    for event in found:
        way[event.row] += event.table.displacement_m or (0.0, 0.0)
    return way


def standing(experiment: Experiment, t: float) -> Sequence[bool]:
    """(O,) which of the arena's obstacles are there at a time, seconds: the scenario's own, and those of events."""
    placed = [event.lasts(t) for event in experiment.events if event.kind == OBSTACLE]
    return [*[True] * (len(experiment.arena.obstacles) - len(placed)), *placed]


def whereabouts(event: Event, trajectory: Trajectory) -> tuple[float, float] | None:
    """Where an event happens, metres: at its agent, in the middle of its edge, at its obstacle; None for nowhere."""
    points = trajectory.points[int(np.abs(trajectory.t - event.begin).argmin())]
    if event.row is not None:
        place = points[event.row]
    elif event.pair is not None:
        place = points[list(event.pair)].mean(axis=0)
    elif event.obstacle is not None:
        place = event.obstacle.vertices.mean(axis=0)
    else:
        return None
    x, y = place.tolist()
    return x, y
