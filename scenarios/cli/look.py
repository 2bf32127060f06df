"""Commands that look: what scenarios there are, what one promises, what may stand in a scenario file."""

from __future__ import annotations

import json
from pathlib import Path

import click

from scenarios.cli import options


@click.command("list")
@options.as_json
def list_command(as_json: bool) -> None:
    """What scenarios there are."""
    if as_json:
        from scenarios.definition.files.library import describe_library

        click.echo(json.dumps(describe_library(), indent=2))
        return
    from scenarios.report.catalogue import print_library
    from scenarios.terminal import new_console

    print_library(new_console())


@click.command()
@options.scenario
@options.seed("Seed of random starts.")
@options.changes
@options.as_json
def show(scenario: str, seed: int, changes: tuple[str, ...], as_json: bool) -> None:
    """Graph, angles, assumptions, predicted rates and end of SCENARIO (a name or a file)."""
    from scenarios.definition.experiment import open_experiment
    from scenarios.report.experiment import print_experiment
    from scenarios.report.foretold import foretold
    from scenarios.terminal import new_console

    experiment = open_experiment(scenario, changes)
    if as_json:
        click.echo(json.dumps(foretold(experiment, seed), indent=2))
    else:
        print_experiment(new_console(), experiment, seed)


@click.command()
@options.markdown("Write a Markdown table instead.")
def keys(markdown: Path | None) -> None:
    """Every key of a scenario file: what it may be, its default, its meaning."""
    from scenarios.definition import keys as reference
    from scenarios.report.catalogue import print_keys
    from scenarios.storage.files import write_text
    from scenarios.terminal import new_console

    if markdown is None:
        print_keys(new_console())
    else:
        write_text(markdown, reference.markdown(), "--markdown")
