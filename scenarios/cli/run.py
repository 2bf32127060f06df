"""Commands that make one run, and open what was recorded."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED
from scenarios.errors import InputError, plain

if TYPE_CHECKING:
    from scenarios.recording.viewer import Live


@click.command()
@options.scenario
@click.option("--seed", type=click.IntRange(min=0), help="Seed of all randomness.  [default: 0, or that of RUN]")
@options.plant
@options.safety("none, decentralised, centralised or robotarium.")
@options.duration
@options.changes
@options.out("Run folder.  [default: runs/SCENARIO-PLANT-seedN]")
@click.option("--start-from", metavar="RUN", type=click.Path(path_type=Path), help="Begin where that run ended.")
@click.option("--recording/--no-recording", "recorded", default=True, help="Whether to write recording.rrd.")
@click.option("--live", is_flag=True, help="Watch the run in a viewer, one that is open or a new one.")
@click.option("--speed", type=float, help="With --live: simulated s per s.  [default: 1]")
@options.as_json
def run(
    scenario: str,
    seed: int | None,
    plant: str | None,
    safety: str | None,
    duration: float | None,
    changes: tuple[str, ...],
    out: Path | None,
    start_from: Path | None,
    recorded: bool,
    live: bool,
    speed: float | None,
    as_json: bool,
) -> None:
    """Run SCENARIO (a name or a file), print its result and write its run folder.

    Of a run folder, or the scenario.json in one, the same run is made again, bit for bit: seed, plant, safety, duration
    and own law as they were. What options change is told.
    """
    from scenarios.definition.experiment import open_experiment, require_safety
    from scenarios.definition.load import changed
    from scenarios.one_run import run_to_folder
    from scenarios.storage import again, run_folder
    from scenarios.terminal import new_console

    if scenario.endswith(".py"):
        raise InputError(f"{scenario}: a script, not a scenario; expected `formation script {scenario}`")
    changes = changed(changes, plant, safety)
    if again.is_recorded(scenario):
        experiment, seed_before = again.open_again(scenario, changes, duration)
        click.echo(plain(again.notice(scenario, seed_before, seed, changes, duration)), err=as_json)
        seed = seed_before if seed is None else seed
    else:
        experiment = open_experiment(scenario, changes, duration)
    seed = seed or 0
    if start_from is not None:
        experiment = again.begin_where(experiment, start_from)
    require_safety(experiment, safety)
    folder = out or run_folder.default_path(experiment.file.name, experiment.plant, seed)
    reached = run_to_folder(experiment, seed, folder, new_console(stderr=as_json), recorded, _live(live, speed))
    if as_json:
        click.echo((folder / run_folder.RESULT).read_text(encoding="utf-8"), nl=False)
    if not reached:
        raise SystemExit(MISSED)


@click.command()
@click.argument(
    "runs", nargs=-1, required=True, metavar="RUN [RUN]", type=click.Path(path_type=Path),
    shell_complete=options.complete_run,
)  # fmt: skip
@click.option("--web", is_flag=True, help="In the browser; served to this machine alone.")
def replay(runs: tuple[Path, ...], web: bool) -> None:
    """Open the recording of a run, or of two runs beside each other, in the viewer."""
    from scenarios.replay import replay as show_runs
    from scenarios.terminal import new_console

    if len(runs) > 2:
        raise InputError(f"replay: expected one run folder or two, got {len(runs)}")
    show_runs(runs, web, new_console())


def _live(live: bool, speed: float | None) -> Live | None:
    if not live:
        if speed is not None:
            raise InputError("--speed: needs --live")
        return None
    if speed is not None and not 0.0 < speed < math.inf:
        raise InputError(f"--speed: expected a positive number, got {speed:g}")
    from scenarios.recording.viewer import Live

    return Live() if speed is None else Live(speed)
