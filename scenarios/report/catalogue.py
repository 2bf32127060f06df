"""What the command line prints of scenario files: those that there are, and what may stand in one. Loads no numpy."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape

from scenarios.definition.files.library import describe_library
from scenarios.terminal import new_table, print_table


def print_library(console: Console) -> None:
    """The scenarios that come with the project."""
    table = new_table("scenario", "agents", "time (s)", "plant", "title")
    for s in describe_library():
        table.add_row(s["scenario"], str(s["agents"]), f"{s['duration_s']:g}", s["plant"], escape(s["title"]))
    print_table(console, table)


def print_keys(console: Console) -> None:
    """The reference of the scenario file."""
    from scenarios.definition.keys import keys  # loads pydantic

    table = new_table("key", "kind", "default", "meaning")
    for key in keys():
        table.add_row(*(escape(part) for part in (key.name, key.kind, key.default, key.meaning)))
    print_table(console, table)
