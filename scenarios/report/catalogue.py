"""What the command line prints of scenario files: those that there are, and what may stand in one. Loads no numpy."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.markup import escape

from scenarios.definition.keys import keys
from scenarios.definition.load import library, load
from scenarios.definition.schema import Scenario
from scenarios.terminal import new_table, print_table


def describe_library() -> list[dict[str, Any]]:
    """The scenarios that come with the project, each with what tells it from the others."""
    described = []
    for name in library():
        s = load(name).scenario
        seconds = s.duration_s or sum(phase.duration_s for phase in s.phases)
        described.append(
            {"scenario": name, "agents": _agents(s), "duration_s": seconds, "plant": s.plant.name, "title": s.title}
        )
    return described


def print_library(console: Console) -> None:
    """The scenarios that come with the project."""
    table = new_table("scenario", "agents", "time (s)", "plant", "title")
    for s in describe_library():
        table.add_row(s["scenario"], str(s["agents"]), f"{s['duration_s']:g}", s["plant"], escape(s["title"]))
    print_table(console, table)


def print_keys(console: Console) -> None:
    """The reference of the scenario file."""
    table = new_table("key", "kind", "default", "meaning")
    for key in keys():
        table.add_row(*(escape(part) for part in (key.name, key.kind, key.default, key.meaning)))
    print_table(console, table)


def _agents(scenario: Scenario) -> int:
    return len(scenario.agents) if scenario.random_formation is None else scenario.random_formation.agents
