"""What the command line prints of scenario files: those that there are, and what may stand in one. Loads no numpy."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape

from scenarios.definition.keys import keys
from scenarios.definition.load import library, load
from scenarios.definition.schema import Scenario
from scenarios.terminal import new_table, print_table


def print_library(console: Console) -> None:
    """The scenarios that come with the project."""
    table = new_table("scenario", "agents", "time (s)", "plant", "title")
    for name in library():
        s = load(name).scenario
        seconds = s.duration_s or sum(phase.duration_s for phase in s.phases)
        table.add_row(name, str(_agents(s)), f"{seconds:g}", s.plant.name, escape(s.title))
    print_table(console, table)


def print_keys(console: Console) -> None:
    """The reference of the scenario file."""
    table = new_table("key", "kind", "default", "meaning")
    for key in keys():
        table.add_row(*(escape(part) for part in (key.name, key.kind, key.default, key.meaning)))
    print_table(console, table)


def _agents(scenario: Scenario) -> int:
    return len(scenario.agents) if scenario.random_formation is None else scenario.random_formation.agents
