"""Arguments and options that several commands share, each defined once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import click

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

Option = Callable[[Any], Any]
"""Decorates the function of a command."""


def completed(names: Callable[[], Iterator[str]], otherwise: str = "plain") -> Callable[..., list[CompletionItem]]:
    """What the shell offers behind the begin of a word: names, or where none fits, files (``file``, ``dir``)."""

    def complete(_ctx: click.Context, _param: click.Parameter, begin: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        fitting = [CompletionItem(name) for name in names() if name.startswith(begin)]
        return fitting or [CompletionItem(begin, type=otherwise)]

    return complete


def _library() -> Iterator[str]:
    from scenarios.definition.files.library import library

    yield from library()


def _plants() -> Iterator[str]:
    from scenarios.definition.schema import PlantTable

    yield from get_args(PlantTable.model_fields["name"].annotation)


def _filters() -> Iterator[str]:
    from scenarios.definition.schema import SafetyTable

    yield from get_args(SafetyTable.model_fields["filter"].annotation)


def _keys() -> Iterator[str]:
    from scenarios.definition.keys import keys

    yield from (f"{key.name}=" for key in keys() if "[]" not in key.name)


def _runs() -> Iterator[str]:
    """The finished runs below ``runs``, newest first."""
    from scenarios.storage.run_folder import RESULT

    yield from _folders_with(RESULT)


def _sweeps() -> Iterator[str]:
    """The finished sweeps below ``runs``, newest first."""
    from scenarios.studies.sweep.folder import SUMMARY

    yield from _folders_with(SUMMARY)


def _runs_and_sweeps() -> Iterator[str]:
    yield from _runs()
    yield from _sweeps()


def _folders_with(name: str) -> Iterator[str]:
    found = sorted(Path("runs").glob(f"*/{name}"), key=lambda path: path.stat().st_mtime, reverse=True)
    yield from (str(path.parent) for path in found)


complete_scenario = completed(_library, "file")
complete_run = completed(_runs, "dir")
complete_run_or_sweep = completed(_runs_and_sweeps, "dir")
complete_plant = completed(_plants)
complete_filter = completed(_filters)
complete_key = completed(_keys)

scenario = click.argument("scenario", shell_complete=complete_scenario)
run_folder = click.argument("run_folder", metavar="RUN", type=click.Path(path_type=Path), shell_complete=complete_run)
run_or_sweep = click.argument(
    "run_folder", metavar="RUN|SWEEP", type=click.Path(path_type=Path), shell_complete=complete_run_or_sweep
)
changes = click.option(
    "--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.",
    shell_complete=complete_key,
)  # fmt: skip
plant = click.option(
    "--plant", metavar="P", help="single_integrator, unicycle, saturated or pymunk.", shell_complete=complete_plant
)
duration = click.option("--duration", type=float, metavar="S", help="Seconds to run instead of the scenario's own.")
workers = click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one per processor]")

as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON instead, for programs.")


def seed(of: str) -> Option:
    """The seed of one run; ``of`` says of what."""
    return click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help=of)


def safety(filters: str) -> Option:
    """The safety filter, in place of the scenario's; ``filters`` says which there are."""
    return click.option("--safety", metavar="F", help=filters, shell_complete=complete_filter)


def out(what: str) -> Option:
    """The folder that a command writes; ``what`` says what it holds."""
    return click.option("--out", type=click.Path(path_type=Path), help=what)


def markdown(what: str) -> Option:
    """The file for a report as Markdown; ``what`` says of what."""
    return click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help=what)


def look(command: Any) -> Any:
    """How figures look: their width and their type."""
    for option in (
        click.option("--font-size", type=float, metavar="PT", help="Points of labels and titles.  [default: 7.5]"),
        click.option("--font", metavar="FAMILY", help="serif, sans or a family's name.  [default: serif]"),
        click.option("--width", metavar="W", help="Of the figures, 3.4in or 86mm, say.  [default: 3.4in]"),
    ):
        command = option(command)
    return command
