"""A target shape that changes on the way: the scenario of each shape, and the phases that begin with one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from formation import Phase
from scenarios.definition.events.event import RESHAPE, SAME_TIME, Event
from scenarios.definition.schema import EventTable, Scenario, TargetTable


def reshaped(scenario: Scenario, table: EventTable) -> Scenario:
    """The scenario with the target positions, and the neighbours, of a reshape in the place of its own; no events."""
    agents = []
    for agent in scenario.agents:
        update: dict[str, object] = {"target": (table.target_m or ())[agent.id - 1]}
        if table.neighbours is not None:
            update["neighbours"] = table.neighbours[agent.id - 1]
        agents.append(agent.model_copy(update=update))
    return scenario.model_copy(update={"agents": tuple(agents), "target": TargetTable(), "events": ()})


def cut(phases: Iterable[Phase], events: Sequence[Event]) -> tuple[tuple[Phase, ...], tuple[int, ...]]:
    """The phases cut where the shape changes, and of each how many changes came before its end.

    A part of a phase that a reshape begins is called as the reshape is.
    """
    changes = [event for event in events if event.kind == RESHAPE]
    parts, shapes = [], []
    begin, done = 0.0, 0
    for phase in phases:
        start, end, name = begin, begin + phase.duration, phase.name
        while done < len(changes) and changes[done].begin < end - SAME_TIME:
            at = changes[done].begin
            if at > begin + SAME_TIME:
                parts.append(replace(phase, name=name, duration=at - begin))
                shapes.append(done)
                begin = at
            name = changes[done].table.name or f"shape {done + 2}"
            done += 1
        parts.append(replace(phase, name=name, duration=phase.duration if begin == start else end - begin))
        shapes.append(done)
        begin = end
    return tuple(parts), tuple(shapes)
