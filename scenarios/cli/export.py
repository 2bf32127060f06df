"""The command that takes a scenario to the testbed."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.errors import InputError


@click.command()
@options.scenario
@options.seed("Seed of random starts.")
@options.safety("none, or any filter for the Robotarium's certificate.")
@options.duration
@options.changes
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write to this file instead of printing.")
@click.option("--force", is_flag=True, help="Replace the file of --out, with whatever was changed in it.")
def export(
    scenario: str,
    seed: int,
    safety: str | None,
    duration: float | None,
    changes: tuple[str, ...],
    out: Path | None,
    force: bool,
) -> None:
    """Print a script that runs SCENARIO (a name or a file) on the Robotarium: numpy and rps, nothing else.

    A safety filter becomes the Robotarium's certificate. What a script cannot carry is refused.
    """
    from scenarios.definition.experiment import open_experiment
    from scenarios.export.portable import crowded, start_poses
    from scenarios.export.script import script
    from scenarios.measures.predictions.remarks import remarks
    from scenarios.storage.files import write_whole

    changes = options.changed(changes, safety=safety)
    experiment = open_experiment(scenario, changes, duration)
    text = script(experiment, seed)
    notes = remarks(experiment, seed)
    if (remark := crowded(start_poses(experiment, seed))) is not None:
        notes.append(remark)
    for remark in notes:
        click.echo(f"note: {remark}", err=True)
    if out is None:
        click.echo(text, nl=False)
        return
    if out.exists() and not force:
        raise InputError(f"--out {out}: exists, and may hold changes of yours; --force replaces it")
    write_whole(out, text.encode())
