"""The command line ``formation``. Heavy packages are imported by the commands that use them."""

from __future__ import annotations

import gc
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.errors import InputError, did_you_mean
from scenarios.storage.run_folder import write_text

if TYPE_CHECKING:
    from rich.console import Console

    from scenarios.recording.viewer import Live

DONE, MISSED, BAD_INPUT = 0, 1, 2
"""Exit codes: done; a comparison missed or a run did not reach its goal; bad input."""


class Commands(click.Group):
    """The commands, with the nearest name for a misspelt one."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and not args[0].startswith("-") and args[0] not in self.commands:
            raise InputError(f"command: no command named {args[0]!r}, {did_you_mean(args[0], self.commands)}")
        return super().resolve_command(ctx, args)


@click.group(cls=Commands, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="angle-formation")
@click.pass_context
def cli(ctx: click.Context) -> None:
    """Angle-constrained formation control of differential-drive robots."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


@cli.command("list")
def list_command() -> None:
    """What scenarios there are."""
    from scenarios.report.catalogue import print_library

    print_library(_console())


@cli.command()
@click.argument("scenario")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help="Seed of random starts.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
def show(scenario: str, seed: int, changes: tuple[str, ...]) -> None:
    """Graph, angles, assumptions, predicted rates and end of SCENARIO (a name or a file)."""
    from scenarios.definition.experiment import open_experiment
    from scenarios.report.printout import print_experiment

    print_experiment(_console(), open_experiment(scenario, changes), seed)


@cli.command()
@click.argument("scenario")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help="Seed of all randomness.")
@click.option("--plant", metavar="P", help="single_integrator, unicycle, saturated or pymunk.")
@click.option("--safety", metavar="F", help="none, decentralised, centralised or robotarium.")
@click.option("--duration", type=float, metavar="S", help="Seconds to run instead of the scenario's own.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
@click.option("--out", type=click.Path(path_type=Path), help="Run folder.  [default: runs/SCENARIO-PLANT-seedN]")
@click.option("--recording/--no-recording", "recorded", default=True, help="Whether to write recording.rrd.")
@click.option("--live", is_flag=True, help="Watch the run in a viewer, one that is open or a new one.")
@click.option(
    "--speed", type=click.FloatRange(min=0.0, min_open=True), help="With --live: simulated s per s.  [default: 1]"
)
def run(
    scenario: str,
    seed: int,
    plant: str | None,
    safety: str | None,
    duration: float | None,
    changes: tuple[str, ...],
    out: Path | None,
    recorded: bool,
    live: bool,
    speed: float | None,
) -> None:
    """Run SCENARIO (a name or a file), print its result and write its run folder."""
    from scenarios.definition.experiment import open_experiment
    from scenarios.one_run import run_to_folder

    if plant is not None:
        changes = (*changes, f'plant.name="{plant}"')
    if safety is not None:
        changes = (*changes, f'safety.filter="{safety}"')
    experiment = open_experiment(scenario, changes, duration)
    if safety is not None and safety != experiment.safety:
        raise InputError(f"--safety {safety}: the plant {experiment.plant} has no robots to keep apart, expected none")
    if not run_to_folder(experiment, seed, out, _console(), recorded, _live(live, speed)):
        raise SystemExit(MISSED)


@cli.command()
@click.argument("runs", nargs=-1, required=True, metavar="RUN [RUN]", type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="In the browser; served to this machine alone.")
def replay(runs: tuple[Path, ...], web: bool) -> None:
    """Open the recording of a run, or of two runs beside each other, in the viewer."""
    from scenarios.replay import replay as show_runs

    if len(runs) > 2:
        raise InputError(f"replay: expected one run folder or two, got {len(runs)}")
    show_runs(runs, web, _console())


@cli.command()
@click.option("--starts", default=1000, show_default=True, type=click.IntRange(min=1), help="Random starts per law.")
@click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help="Write the table to this file too.")
def laws(starts: int, markdown: Path | None) -> None:
    """Compare the angle law with the displacement, bearing and distance laws."""
    from scenarios.report.printout import print_laws
    from scenarios.studies import laws as comparison
    from scenarios.terminal import progress_bar

    console = _console()
    with progress_bar(console, "laws") as advance:
        shares = comparison.compare(starts, advance)
    print_laws(console, shares)
    if markdown is not None:
        write_text(markdown, comparison.markdown(shares, starts), "--markdown")


@cli.command()
@click.argument("scenario")
@click.option("--starts", default=100, show_default=True, type=click.IntRange(min=0), help="Random starts; 0 for none.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
@click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help="Write the table to this file too.")
def audit(scenario: str, starts: int, changes: tuple[str, ...], markdown: Path | None) -> None:
    """Find out what the law of SCENARIO (a name or a file) is like, your own above all.

    Whether it is local and free of frames, what it fixes, whether it is stable, how often it reaches the goal.
    """
    from scenarios.studies import audit as auditing
    from scenarios.terminal import progress_bar

    console = _console()
    with progress_bar(console, "audit") as advance:
        experiment, findings = auditing.audit_scenario(scenario, changes, starts, advance)
    auditing.print_audit(console, experiment, findings)
    if markdown is not None:
        write_text(markdown, auditing.markdown(experiment, findings, scenario, changes, starts), "--markdown")
    if not auditing.passed(findings):
        raise SystemExit(MISSED)


@cli.command()
@click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help="Write a Markdown table instead.")
def keys(markdown: Path | None) -> None:
    """Every key of a scenario file: what it may be, its default, its meaning."""
    from scenarios.definition import keys as reference
    from scenarios.report.catalogue import print_keys

    if markdown is None:
        print_keys(_console())
    else:
        write_text(markdown, reference.markdown(), "--markdown")


@cli.command()
@click.argument("run_folder", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the figures.  [default: RUN]")
@click.option(
    "--format", "formats", multiple=True, type=click.Choice(["png", "pdf", "svg"]), default=("png", "pdf"),
    show_default=True, help="May be given several times.",
)  # fmt: skip
def plot(run_folder: Path, out: Path | None, formats: tuple[str, ...]) -> None:
    """Draw the paper's figures of RUN, the folder of a finished run."""
    from scenarios.figures import names_for
    from scenarios.figures import plot as draw
    from scenarios.measures.metrics import measure
    from scenarios.storage.run_folder import read

    finished = read(run_folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    metrics = measure(experiment, trajectory)
    console = _console()
    for path in draw(experiment, trajectory, metrics, out or run_folder, names_for(experiment), formats):
        console.print(str(path), markup=False)


@cli.command()
@click.argument("run_folder", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--format", "form", type=click.Choice(["gif", "mp4"]), default="gif", show_default=True)
@click.option("--speed", default=4.0, show_default=True, metavar="X", help="Simulated seconds per second.")
@click.option("--fps", default=20.0, show_default=True, metavar="N", help="Frames per second.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the film.  [default: RUN]")
def animate(run_folder: Path, form: str, speed: float, fps: float, out: Path | None) -> None:
    """Film RUN, the folder of a finished run, as a GIF or with ffmpeg as an MP4."""
    from scenarios.figures import animate as film
    from scenarios.measures.metrics import measure
    from scenarios.storage.run_folder import read
    from scenarios.terminal import progress_bar

    finished = read(run_folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    console, path = _console(), (out or run_folder) / f"animation.{form}"
    with progress_bar(console, path.name) as advance:
        film(experiment, trajectory, measure(experiment, trajectory), path, speed, fps, advance)
    console.print(str(path), markup=False)


@cli.command()
@click.argument("scenarios", nargs=-1, metavar="[SCENARIO ...]")
@click.option("--baselines", type=click.Path(path_type=Path), help="Their folder.  [default: the library's]")
@click.option("--portable", is_flag=True, help="Allow the spread between machines on the baselines' own machine too.")
@click.option("--junit", type=click.Path(path_type=Path, dir_okay=False), help="Write a JUnit XML report.")
@click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help="Write a Markdown report.")
@click.option("--out", default="runs/check", show_default=True, type=click.Path(path_type=Path), help="For misses.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one per processor]")
@click.option("--update", is_flag=True, help="Make the baselines anew instead, and show what changed.")
def check(
    scenarios: tuple[str, ...],
    baselines: Path | None,
    portable: bool,
    junit: Path | None,
    markdown: Path | None,
    out: Path,
    workers: int | None,
    update: bool,
) -> None:
    """Run scenarios again and compare them with their baselines; all that have one, if none is named.

    Exit code 1 on a miss. The worst misses leave run folders in --out.
    """
    from scenarios.studies.check.command import check_command, update_command

    if not update:
        if not check_command(scenarios, baselines, portable, junit, markdown, out, workers, _console()):
            raise SystemExit(MISSED)
        return
    if junit is not None or markdown is not None:
        raise InputError(f"--{'markdown' if junit is None else 'junit'}: not together with --update")
    update_command(scenarios, baselines, workers, _console())


@cli.command("sweep")
@click.argument("scenario")
@click.option("--seeds", required=True, metavar="A:B", help="Seeds A to B - 1, one run each.")
@click.option("--plant", metavar="P", help="single_integrator, unicycle, saturated or pymunk.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
@click.option("--vary", "varied", multiple=True, metavar="KEY=V1,V2,...", help="Run with each of these values.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one per processor]")
@click.option("--scheduler", metavar="ADDRESS", help="A running dask scheduler's, tcp://host:port, in their place.")
@click.option("--out", type=click.Path(path_type=Path), help="[default: runs/sweep-SCENARIO-PLANT-seedsA-B]")
def sweep_command(
    scenario: str,
    seeds: str,
    plant: str | None,
    changes: tuple[str, ...],
    varied: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    out: Path | None,
) -> None:
    """Run SCENARIO (a name or a file) with many seeds: one row per run, and a summary.

    Where --vary is given several times, every combination of the values is run with every seed. Rows are kept as they
    come, also those of a sweep that is stopped. Exit code 0 whatever the runs gave.
    """
    from scenarios.studies.sweep import open_study, parse_seeds, sweep
    from scenarios.studies.sweep_table import print_sweep
    from scenarios.studies.variations import parse_variations
    from scenarios.terminal import progress_bar
    from scenarios.work.pool import spread

    if plant is not None:
        changes = (*changes, f'plant.name="{plant}"')
    console = _console()
    study = open_study(scenario, changes, parse_variations(varied, changes), parse_seeds(seeds))
    with spread(workers, scheduler) as run_all, progress_bar(console, "sweep") as advance:
        summaries, folder = sweep(study, out, run_all, advance)
    print_sweep(console, study, summaries, folder)


@cli.command()
@click.option("--markdown", type=click.Path(path_type=Path, dir_okay=False), help="Write the page to this file.")
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one per processor]")
def reproduce(markdown: Path | None, workers: int | None) -> None:
    """Put the paper's numbers beside what every plant measures."""
    from scenarios.studies import reproduction
    from scenarios.terminal import progress_bar
    from scenarios.work.pool import available_workers

    console = _console()
    with progress_bar(console, "reproduce") as advance:
        results = reproduction.reproduce(workers or available_workers(), advance)
    page = reproduction.markdown(results)
    if markdown is None:
        click.echo(page, nl=False)
    else:
        write_text(markdown, page, "--markdown")


@cli.command()
@click.argument("scenario")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0), help="Seed of random starts.")
@click.option("--safety", metavar="F", help="none, or any filter for the Robotarium's certificate.")
@click.option("--duration", type=float, metavar="S", help="Seconds to run instead of the scenario's own.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key of the scenario.")
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
    from scenarios.measures.misfits import misfits
    from scenarios.storage.files import write_whole

    if safety is not None:
        changes = (*changes, f'safety.filter="{safety}"')
    experiment = open_experiment(scenario, changes, duration)
    text = script(experiment, seed)
    remarks = [f"does not fit: {misfit}" for misfit in misfits(experiment, experiment.initial_points(seed))]
    if (remark := crowded(start_poses(experiment, seed))) is not None:
        remarks.append(remark)
    for remark in remarks:
        click.echo(f"note: {remark}", err=True)
    if out is None:
        click.echo(text, nl=False)
        return
    if out.exists() and not force:
        raise InputError(f"--out {out}: exists, and may hold changes of yours; --force replaces it")
    write_whole(out, text.encode())


def _console() -> Console:
    from rich.console import Console

    # Where there is no terminal, wide enough for every table.
    return Console(highlight=False, soft_wrap=True, width=shutil.get_terminal_size((160, 25)).columns)


def _live(live: bool, speed: float | None) -> Live | None:
    if not live:
        if speed is not None:
            raise InputError("--speed: needs --live")
        return None
    from scenarios.recording.viewer import Live

    return Live() if speed is None else Live(speed)


def main() -> None:
    """Run the command line: errors on one line on stderr, never a traceback for bad input."""
    gc.set_threshold(50_000, 20, 50)  # loading packages makes objects and frees none: searching them costs 0.2 s a run
    try:
        cli.main(standalone_mode=False)
    except InputError as error:
        _fail(str(error))
    except click.ClickException as error:
        _fail(error.format_message())
    except click.Abort:
        sys.exit(130)


def _fail(message: str) -> None:
    click.echo(f"formation: {' '.join(message.split())}", err=True)
    sys.exit(BAD_INPUT)
