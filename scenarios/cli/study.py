"""Commands that ask what a law is like, and the paper whether it holds."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED


@click.command()
@click.option("--starts", default=1000, show_default=True, type=click.IntRange(min=1), help="Random starts per law.")
@options.markdown("Write the table to this file too.")
def laws(starts: int, markdown: Path | None) -> None:
    """Compare the angle law with the displacement, bearing and distance laws."""
    from scenarios.storage.files import write_text
    from scenarios.studies import laws as comparison
    from scenarios.terminal import new_console, progress_bar

    console = new_console()
    with progress_bar(console, "laws") as advance:
        shares = comparison.compare(starts, advance)
    comparison.print_laws(console, shares)
    if markdown is not None:
        write_text(markdown, comparison.markdown(shares, starts), "--markdown")


@click.command()
@options.scenario
@click.option("--starts", default=100, show_default=True, type=click.IntRange(min=0), help="Random starts; 0 for none.")
@options.changes
@options.markdown("Write the table to this file too.")
def audit(scenario: str, starts: int, changes: tuple[str, ...], markdown: Path | None) -> None:
    """Find out what the law of SCENARIO (a name or a file) is like, your own above all.

    Whether it is local and free of frames, what it fixes, whether it is stable, how often it reaches the goal.
    """
    from scenarios.storage.files import write_text
    from scenarios.studies import audit as auditing
    from scenarios.terminal import new_console, progress_bar

    console = new_console()
    with progress_bar(console, "audit") as advance:
        experiment, findings = auditing.audit_scenario(scenario, changes, starts, advance)
    auditing.print_audit(console, experiment, findings)
    if markdown is not None:
        write_text(markdown, auditing.markdown(experiment, findings, scenario, changes, starts), "--markdown")
    if not auditing.passed(findings):
        raise SystemExit(MISSED)


@click.command()
@options.markdown("Write the page to this file.")
@options.workers
def reproduce(markdown: Path | None, workers: int | None) -> None:
    """Put the paper's numbers beside what every plant measures."""
    from scenarios.storage.files import write_text
    from scenarios.studies import reproduction
    from scenarios.terminal import new_console, progress_bar
    from scenarios.work.processes import available_workers

    console = new_console()
    with progress_bar(console, "reproduce") as advance:
        results = reproduction.reproduce(workers or available_workers(), advance)
    page = reproduction.markdown(results)
    if markdown is None:
        click.echo(page, nl=False)
    else:
        write_text(markdown, page, "--markdown")
