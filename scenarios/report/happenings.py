"""What is to happen in a run, and what events did to one, in plain words; nothing of a run without events."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.markup import escape

from scenarios.definition.experiment import Experiment
from scenarios.documents import cell
from scenarios.measures.predictions.stops import spreads
from scenarios.terminal import new_table, print_table


def print_plan(console: Console, experiment: Experiment, start: NDArray[np.float64]) -> None:
    """The events of an experiment, and how far off a stop is predicted to leave each agent."""
    if not experiment.events:
        return
    console.print("\n[bold]Events[/bold]")
    for event in experiment.events:
        console.print(f"- {event.begin:g} s: {escape(event.what)}")
    if not (found := spreads(experiment, start)):
        return
    console.print(
        "\n[bold]What a stop does to the others[/bold]: distance (m) from where each would be, for ideal agents that "
        "have settled before it"
    )
    table = new_table("agent", *(f"at {each.time:g} s, {each.event.number}" for each in found))
    for row in range(experiment.n):
        table.add_row(str(experiment.number(row)), *(_distance(each.errors[row]) for each in found))
    print_table(console, table)


def print_happenings(console: Console, result: dict[str, Any]) -> None:
    """What events did, from the content of ``result.json``."""
    events = result.get("events", [])
    if not events:
        return
    table = new_table("event", "at (s)", "what", "error before (rad)", "largest (rad)", "at goal again (s)")
    for event in events:
        table.add_row(
            str(event["event"]),
            f"{event['begin_s']:g}",
            escape(event["what"]) if event["happened"] else f"{escape(event['what'])}: after the run's end",
            cell(event.get("angle_error_sum_before_rad"), ".1e"),
            cell(event.get("largest_angle_error_sum_rad"), ".1e"),
            cell(event.get("recovered_at_s"), ".1f"),
        )
    print_table(console, table)
    for event in events:
        if "offsets_m" in event:
            _print_offsets(console, result, event)
    console.print()


def _print_offsets(console: Console, result: dict[str, Any], event: dict[str, Any]) -> None:
    offsets = event["offsets_m"]
    console.print(f"\nat {offsets['time_s']:.1f} s, after {escape(event['what'])}:")
    table = new_table("agent", "predicted off (m)", "measured off (m)")
    for number, predicted, measured in zip(result["agents"], offsets["predicted"], offsets["measured"], strict=True):
        table.add_row(str(number), _distance(predicted), cell(measured, ".4f"))
    print_table(console, table)


def _distance(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}"
