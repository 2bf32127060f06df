"""The command that takes a scenario to the testbed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED
from scenarios.errors import InputError

if TYPE_CHECKING:
    from scenarios.definition.experiment import Experiment

RUNS, MOST_RUNS = 10, 1000
"""Of a check, on each plant."""


@click.command()
@options.scenario
@options.seed("Seed of random starts.")
@options.safety("none, or any filter for the Robotarium's certificate.")
@options.duration
@options.changes
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write to this file instead of printing.")
@click.option("--force", is_flag=True, help="Replace the file of --out, with whatever was changed in it.")
@click.option("--check", "checked", is_flag=True, help="Run it as the testbed would instead of printing it.")
@click.option("--runs", type=click.IntRange(min=1, max=MOST_RUNS), help="With --check: on each plant.  [default: 10]")
def export(
    scenario: str,
    seed: int,
    safety: str | None,
    duration: float | None,
    changes: tuple[str, ...],
    out: Path | None,
    force: bool,
    checked: bool,
    runs: int | None,
) -> None:
    """Print a script that runs SCENARIO (a name or a file) on the Robotarium: numpy and rps, nothing else.

    A safety filter becomes the Robotarium's certificate. What a script cannot carry is refused. The script is tried
    once, and a note says where it misses. With --check it is run, from the chargers on as on the testbed, on
    `saturated`, on `pymunk` and with measured robots, with several seeds; exit code 1 where a run does not arrive.
    """
    from scenarios.definition.experiment import open_experiment
    from scenarios.definition.load import changed
    from scenarios.export.portable import crowded, start_poses
    from scenarios.export.script import script
    from scenarios.measures.predictions.remarks import remarks
    from scenarios.storage.files import write_whole
    from scenarios.terminal import new_console

    changes = changed(changes, safety=safety)
    experiment = open_experiment(scenario, changes, duration)
    text = script(experiment, seed)
    notes = remarks(experiment, seed)
    if (remark := crowded(experiment, start_poses(experiment, seed))) is not None:
        notes.append(remark)
    if not checked:
        notes.extend(_misses(experiment, text, seed))
    told = new_console(stderr=True)
    for remark in notes:
        told.print(f"note: {remark}", markup=False)
    if out is not None:
        if out.exists() and not force:
            raise InputError(f"--out {out}: exists, and may hold changes of yours; --force replaces it")
        write_whole(out, text.encode())
    if checked:
        _check(experiment, seed, RUNS if runs is None else runs)
    elif runs is not None:
        raise InputError("--runs: needs --check")
    elif out is None:
        click.echo(text, nl=False)


def _misses(experiment: Experiment, text: str, seed: int) -> list[str]:
    """What a rehearsal of the script tells, where it does not arrive."""
    from scenarios.studies import exported

    found = exported.rehearse(experiment, text, seed)
    if found.arrives:
        return []
    return [f"it may miss: on {found.plant}, from within the testbed's tolerance, {exported.why(found, experiment)}"]


def _check(experiment: Experiment, seed: int, runs: int) -> None:
    from scenarios.studies import exported
    from scenarios.terminal import new_console, progress_bar

    console = new_console()
    with progress_bar(console, f"check {experiment.file.name}") as advance:
        found = exported.check(experiment, seed, range(runs), advance=advance)
    exported.print_check(console, experiment, found)
    if not all(each.arrives for each in found):
        raise SystemExit(MISSED)
