"""Commands that make many runs of scenarios: over seeds and values, and against baselines."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED
from scenarios.errors import InputError


@click.command("sweep")
@options.scenario
@click.option("--seeds", required=True, metavar="SEEDS", help="A:B for A to B - 1, N, or a list: 1,5,7:9.")
@options.plant
@options.safety("none, decentralised, centralised or robotarium.")
@options.duration
@options.changes
@click.option(
    "--vary", "varied", multiple=True, metavar="KEY=V1,V2,...", help="Run with each of these values.",
    shell_complete=options.complete_key,
)  # fmt: skip
@options.workers
@click.option("--scheduler", metavar="ADDRESS", help="A running dask scheduler's, tcp://host:port, in their place.")
@options.out("[default: runs/sweep-SCENARIO-PLANT-seedsA-B]")
@click.option("--restart", is_flag=True, help="Make all rows anew, where some are there already.")
@options.as_json
def sweep_command(
    scenario: str,
    seeds: str,
    plant: str | None,
    safety: str | None,
    duration: float | None,
    changes: tuple[str, ...],
    varied: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    out: Path | None,
    restart: bool,
    as_json: bool,
) -> None:
    """Run SCENARIO (a name or a file) with many seeds: one row per run, and a summary.

    Where --vary is given several times, every combination of the values is run with every seed. Rows are kept as they
    come: the same command goes on where a sweep was stopped. Exit code 0 whatever the runs gave.
    """
    from scenarios.definition.load import changed
    from scenarios.studies.project import PROJECT
    from scenarios.studies.sweep.folder import SUMMARY
    from scenarios.studies.sweep.seeds import parse_seeds
    from scenarios.studies.sweep.study import open_study
    from scenarios.studies.sweep.sweep import sweep
    from scenarios.studies.sweep.table import print_sweep
    from scenarios.studies.sweep.variations import parse_variations
    from scenarios.terminal import new_console, progress_bar
    from scenarios.work.spread import spread

    changes = changed(changes, plant, safety)
    console = new_console(stderr=as_json)
    variations = parse_variations(varied, changes)
    study = open_study(scenario, changes, variations, parse_seeds(seeds), duration, safety)
    with spread(workers, scheduler, PROJECT) as run_all, progress_bar(console, "sweep") as advance:
        swept = sweep(study, out, run_all, advance, restart)
    print_sweep(console, study, swept)
    if as_json:
        click.echo((swept.folder / SUMMARY).read_text(encoding="utf-8"), nl=False)


@click.command()
@click.argument("scenarios", nargs=-1, metavar="[SCENARIO ...]", shell_complete=options.complete_scenario)
@click.option("--baselines", type=click.Path(path_type=Path), help="Their folder.  [default: the library's]")
@click.option("--portable", is_flag=True, help="Allow the spread between machines on the baselines' own machine too.")
@click.option("--junit", type=click.Path(path_type=Path, dir_okay=False), help="Write a JUnit XML report.")
@options.markdown("Write a Markdown report.")
@click.option("--out", default="runs/check", show_default=True, type=click.Path(path_type=Path), help="For misses.")
@options.workers
@click.option("--update", is_flag=True, help="Make the baselines anew instead, and show what changed.")
@options.as_json
def check(
    scenarios: tuple[str, ...],
    baselines: Path | None,
    portable: bool,
    junit: Path | None,
    markdown: Path | None,
    out: Path,
    workers: int | None,
    update: bool,
    as_json: bool,
) -> None:
    """Run scenarios again and compare them with their baselines; all that have one, if none is named.

    Exit code 1 on a miss. The worst misses leave run folders in --out.
    """
    from scenarios.studies.check.command import check_command, update_command
    from scenarios.terminal import new_console

    if not update:
        console, tell = new_console(stderr=as_json), click.echo if as_json else None
        if not check_command(scenarios, baselines, portable, junit, markdown, out, workers, console, tell):
            raise SystemExit(MISSED)
        return
    if as_json:
        raise InputError("--json: not together with --update")
    if junit is not None or markdown is not None:
        raise InputError(f"--{'markdown' if junit is None else 'junit'}: not together with --update")
    update_command(scenarios, baselines, workers, new_console())
