"""From the tables of a scenario to its events, each checked by itself and against the others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from formation import Graph
from robots.obstacles import Obstacle
from scenarios.definition.events.event import (
    AT_ONCE,
    DROPOUT,
    EDGE_LOSS,
    MESSAGE_LOSS,
    OBSTACLE,
    PUSH,
    RESHAPE,
    SENSOR,
    STOP,
    Event,
)
from scenarios.definition.schema import EventTable, Scenario
from scenarios.errors import InputError, did_you_mean, located

ALWAYS = ("t_s", "kind")

KEYS = {
    STOP: ("agent", "until_s"),
    PUSH: ("agent", "displacement_m"),
    DROPOUT: ("agent", "until_s"),
    EDGE_LOSS: ("edge", "until_s"),
    SENSOR: ("sensing_range_m", "field_of_view_deg", "edge_loss", "dropout", "until_s"),
    MESSAGE_LOSS: ("message_loss", "until_s"),
    RESHAPE: ("target_m", "neighbours", "name"),
    OBSTACLE: ("vertices_m", "radius_m", "until_s"),
}
"""Which keys belong to which kind."""

REQUIRED = {
    STOP: ("agent",),
    PUSH: ("agent", "displacement_m"),
    DROPOUT: ("agent",),
    EDGE_LOSS: ("edge",),
    SENSOR: (),
    MESSAGE_LOSS: ("message_loss",),
    RESHAPE: ("target_m",),
    OBSTACLE: ("vertices_m",),
}


def build_events(path: str, scenario: Scenario, numbers: Sequence[int], graph: Graph) -> tuple[Event, ...]:
    """The events of a scenario by time; those of one time in the order of the file.

    Args:
        path: of the scenario file, for messages.
        scenario: validated.
        numbers: of the agents as the file has them, row by row.
        graph: who senses whom at the start.

    Raises:
        InputError: an event that cannot be; the message names its place in the file and the key.
    """
    length = sum(phase.duration_s for phase in scenario.phases) or scenario.duration_s or 0.0
    events = []
    for number, table in enumerate(scenario.events, start=1):
        field = f"{path}: events[{number}]"
        _check_keys(field, table)
        _check_times(field, table, length)
        events.append(_event(field, number, table, scenario, list(numbers)))
    _check_overlaps(path, events)
    ordered = sorted(events, key=lambda event: event.begin)
    _check_edges(path, scenario, ordered, list(numbers), graph)
    return tuple(ordered)


def _check_keys(field: str, table: EventTable) -> None:
    given = [key for key in table.model_fields_set if getattr(table, key) is not None and key not in ALWAYS]
    for key in sorted(given):
        if key not in KEYS[table.kind]:
            owners = " or ".join(f'"{kind}"' for kind, keys in KEYS.items() if key in keys)
            raise InputError(f'{field}.{key}: only for kind = {owners}, got "{table.kind}"')
    for key in REQUIRED[table.kind]:
        if key not in given:
            raise InputError(f'{field}.{key}: missing, kind = "{table.kind}" needs it')
    if table.kind == SENSOR and not set(given) - {"until_s"}:
        raise InputError(f"{field}: expected one of {', '.join(KEYS[SENSOR][:-1])} at least, got none")


def _check_times(field: str, table: EventTable, length: float) -> None:
    if not table.t_s < length:
        raise InputError(f"{field}.t_s: expected less than the run's {length:g} s, got {table.t_s:g}")
    if table.until_s is not None and not table.t_s < table.until_s <= length:
        raise InputError(
            f"{field}.until_s: expected more than t_s, {table.t_s:g}, and at most the run's {length:g} s (none for an "
            f"event that never ends), got {table.until_s:g}"
        )


def _check_overlaps(path: str, events: Sequence[Event]) -> None:
    """Two events of one kind about one thing must not be on at one time."""
    for event in events:
        for other in events[: event.number - 1]:
            if (
                event.kind not in (*AT_ONCE, OBSTACLE)
                and event.subject == other.subject
                and event.begin < other.end
                and other.begin < event.end
            ):
                raise InputError(
                    f"{path}: events[{event.number}].t_s: overlaps events[{other.number}], which is the same from "
                    f"{other.begin:g} s {_until(other.end)}, got {event.begin:g}"
                )


def _check_edges(path: str, scenario: Scenario, ordered: Sequence[Event], numbers: list[int], graph: Graph) -> None:
    """An edge that is lost must be there: in the graph of that time, or among those that a law falls back on."""
    senses = {(numbers[k], numbers[i]) for k, i in graph.edges.tolist()}
    if scenario.law.without_neighbour == "another-pair":
        senses |= {(numbers[k], numbers[i]) for k in range(len(numbers)) for i in range(k)}
    for event in ordered:
        if event.kind == RESHAPE and event.table.neighbours is not None:
            senses = {(k, i) for k, each in enumerate(event.table.neighbours, start=1) for i in each}
        if event.kind != EDGE_LOSS or event.table.edge is None or event.table.edge in senses:
            continue
        observer, observed = event.table.edge
        seen = sorted(i for k, i in senses if k == observer)
        whom = ", ".join(map(str, seen)) or "nobody"
        raise InputError(
            f"{path}: events[{event.number}].edge: there is no edge [{observer}, {observed}], agent {observer} senses "
            f"{whom}"
        )


def _event(field: str, number: int, table: EventTable, scenario: Scenario, numbers: list[int]) -> Event:
    kind, begin = table.kind, table.t_s
    end = begin if kind in AT_ONCE else table.until_s or np.inf
    lasting = _until(end)
    if kind in (STOP, PUSH, DROPOUT):
        row = _row(f"{field}.agent", numbers, table.agent)
        who = f"agent {table.agent}"
        if kind == PUSH:
            x, y = table.displacement_m or (0.0, 0.0)
            if x == y == 0.0:
                raise InputError(f"{field}.displacement_m: expected a way, got [0, 0]")
            return Event(number, kind, begin, end, table, f"{who} is pushed by ({x:g}, {y:g}) m", row=row)
        if kind == STOP:
            return Event(number, kind, begin, end, table, f"{who} stops {lasting}", f"{who} goes on", row)
        what, over = f"nobody senses {who} {lasting}", f"{who} is sensed again"
        return Event(number, kind, begin, end, table, what, over, row)
    if kind == EDGE_LOSS and table.edge is not None:
        k, i = (_row(f"{field}.edge", numbers, each) for each in table.edge)
        observer, observed = table.edge
        what = f"agent {observer} does not sense agent {observed} {lasting}"
        return Event(number, kind, begin, end, table, what, f"agent {observer} senses agent {observed}", pair=(k, i))
    if kind == SENSOR:
        if table.field_of_view_deg is not None:
            check_front(f"{field}.field_of_view_deg", scenario)
        changes = [
            text
            for value, text in (
                (table.sensing_range_m, f"robots sense up to {table.sensing_range_m or 0.0:g} m"),
                (table.field_of_view_deg, f"robots see {table.field_of_view_deg or 0.0:g} degrees ahead"),
                (table.edge_loss, f"edges are lost with probability {table.edge_loss or 0.0:g}"),
                (table.dropout, f"robots sense nothing with probability {table.dropout or 0.0:g}"),
            )
            if value is not None
        ]
        return Event(number, kind, begin, end, table, f"{', '.join(changes)} {lasting}", "sensors as before")
    if kind == MESSAGE_LOSS:
        if scenario.velocity_known_by == "all":
            raise InputError(f'{field}.kind: only for velocity_known_by = "leader", got "all"')
        what = f"messages are lost with probability {table.message_loss or 0.0:g} {lasting}"
        return Event(number, kind, begin, end, table, what, "messages as before")
    if kind == RESHAPE:
        _check_reshape(field, table, scenario)
        return Event(number, kind, begin, end, table, f"the shape changes: {table.name or 'a new one'}")
    file, _, place = field.rpartition(": ")
    with located(file, f"{place}.vertices_m"):
        obstacle = Obstacle(np.array(table.vertices_m), table.radius_m or 0.0)
    x, y = obstacle.vertices.mean(axis=0)
    what = f"an obstacle appears at ({x:.3g}, {y:.3g}) m {lasting}"
    return Event(number, kind, begin, end, table, what, "the obstacle is gone", obstacle=obstacle)


def _check_reshape(field: str, table: EventTable, scenario: Scenario) -> None:
    if not scenario.agents or scenario.graph != "given":
        raise InputError(f'{field}.kind: a reshape needs agents and graph = "given"')
    if scenario.reference is not None:
        raise InputError(f"{field}.kind: a reshape needs phases, or neither phases nor a reference")
    n = len(scenario.agents)
    for key in ("target_m", "neighbours"):
        value = getattr(table, key)
        if value is not None and len(value) != n:
            raise InputError(f"{field}.{key}: expected {n} entries, one for each agent, got {len(value)}")


def check_front(field: str, scenario: Scenario) -> None:
    """A field of view belongs to robots that have a front.

    Raises:
        InputError: the plant has points.
    """
    if scenario.plant.name == "single_integrator":
        raise InputError(f"{field}: the plant single_integrator has points without a front, expected none")


def _row(field: str, numbers: list[int], number: int | None) -> int:
    if number not in numbers:
        raise InputError(f"{field}: no agent {number}, {did_you_mean(str(number), map(str, numbers))}")
    return numbers.index(number)


def _until(end: float) -> str:
    return "for good" if end == np.inf else f"until {end:g} s"
