"""Commands that ask what a law is like, and the paper whether it holds."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED


@click.command()
@click.argument("scenario", default="shape")
@click.option("--law", "names", multiple=True, metavar="NAME", help="Only this law; may be given several times.")
@click.option("--starts", default=1000, show_default=True, type=click.IntRange(min=1), help="Random starts per law.")
@click.option(
    "--robots", default=0, show_default=True, type=click.IntRange(0, 1000), help="Seeds on each plant with wheels."
)
@options.changes
@options.markdown("Write the page to this file too.")
@click.option("--figure", type=click.Path(path_type=Path, dir_okay=False), help="Draw starts and ends, a PNG.")
def laws(
    scenario: str,
    names: tuple[str, ...],
    starts: int,
    robots: int,
    changes: tuple[str, ...],
    markdown: Path | None,
    figure: Path | None,
) -> None:
    """Put the laws of the literature side by side on the target of SCENARIO (a name or a file).

    What each needs, where random starts end, what errors do, and how it fares on robots.
    """
    from scenarios.storage.files import write_text
    from scenarios.studies.league.entries import chosen
    from scenarios.studies.league.measure import league
    from scenarios.studies.league.report import markdown as page
    from scenarios.studies.league.report import print_league
    from scenarios.terminal import new_console, progress_bar

    console, entries = new_console(), chosen(names)
    with progress_bar(console, "laws") as advance:
        rows = league(scenario, changes, entries, starts, robots, advance)
    print_league(console, rows, robots)
    if figure is not None:
        from scenarios.studies.league.picture import draw

        draw(rows, figure)
    if markdown is not None:
        write_text(markdown, page(scenario, changes, rows, starts, robots), "--markdown")


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
