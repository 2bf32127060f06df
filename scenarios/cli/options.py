"""Arguments and options that several commands share, each defined once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

Option = Callable[[Any], Any]
"""Decorates the function of a command."""

scenario = click.argument("scenario")
run_folder = click.argument("run_folder", metavar="RUN", type=click.Path(path_type=Path))
changes = click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
plant = click.option("--plant", metavar="P", help="single_integrator, unicycle, saturated or pymunk.")
duration = click.option("--duration", type=float, metavar="S", help="Seconds to run instead of the scenario's own.")
workers = click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one per processor]")


def seed(of: str) -> Option:
    """The seed of one run; ``of`` says of what."""
    return click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help=of)


def safety(filters: str) -> Option:
    """The safety filter, in place of the scenario's; ``filters`` says which there are."""
    return click.option("--safety", metavar="F", help=filters)


def out(what: str) -> Option:
    """The folder that a command writes; ``what`` says what it holds."""
    return click.option("--out", type=click.Path(path_type=Path), help=what)


def markdown(what: str) -> Option:
    """The file for a report as Markdown; ``what`` says of what."""
    return click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help=what)
