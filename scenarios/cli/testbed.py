"""Commands that ask the testbed itself: a log of a real robot."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.cli.exits import MISSED

log_argument = click.argument("log", type=click.Path(path_type=Path))
robot_option = click.option(
    "--robot", default=1, show_default=True, type=click.IntRange(min=1), help="Which one, of a log of several."
)


@click.command()
@log_argument
@robot_option
@click.option("--out", type=click.Path(path_type=Path), help="Folder.  [default: runs/identify-LOG]")
@options.markdown("Write the tables to this file too.")
def identify(log: Path, robot: int, out: Path | None, markdown: Path | None) -> None:
    """Find a robot's numbers in LOG: a folder of .npy arrays, or an .npz, .npy, .csv or .mat file.

    It needs x, y, theta and both encoders' counts of every turn of the loop. Writes robot.toml, which scenarios name by
    robot.file, and a figure of what the numbers leave unexplained.
    """
    from scenarios.figures.studies.residuals import residuals
    from scenarios.figures.style import print_style, render
    from scenarios.storage.files import write_text, write_whole
    from scenarios.studies import identification
    from scenarios.terminal import new_console

    console = new_console()
    found = identification.identified(log, robot)
    identification.print_identified(console, found)
    folder = out or Path("runs") / f"identify-{log.stem}"
    write_text(folder / "robot.toml", identification.robot_file_text(found, log.name), "--out")
    with print_style():
        write_whole(folder / "figure-residuals.png", render(residuals(found), "png"))
    if markdown is not None:
        write_text(markdown, "\n".join(identification.markdown(found)) + "\n", "--markdown")
    console.print(f"robot file: {folder / 'robot.toml'}", markup=False)


@click.command("ladder")
@options.scenario
@click.option("--seeds", default="0:20", show_default=True, metavar="A:B", help="Seeds A to B - 1 on every rung.")
@options.changes
@options.workers
@click.option("--out", type=click.Path(path_type=Path), help="Folder.  [default: runs/ladder-SCENARIO]")
@options.markdown("Write the table to this file too.")
def ladder_command(
    scenario: str, seeds: str, changes: tuple[str, ...], workers: int | None, out: Path | None, markdown: Path | None
) -> None:
    """Run SCENARIO on five rungs, from the theory to measured robots: what each adds to the error.

    The last rung is pymunk with robot.model = "measured". Writes rows.csv and a figure.
    """
    from scenarios.definition.experiment import open_experiment
    from scenarios.figures.studies.ladder import ladder as draw
    from scenarios.figures.style import print_style, render
    from scenarios.storage.files import write_text, write_whole
    from scenarios.studies import ladder
    from scenarios.studies.project import PROJECT
    from scenarios.studies.sweep.seeds import parse_seeds
    from scenarios.terminal import new_console, progress_bar
    from scenarios.work.spread import spread

    console, goal = new_console(), open_experiment(scenario, changes).goal
    with spread(workers, None, PROJECT) as run_all, progress_bar(console, "ladder") as advance:
        climbed = ladder.climb(scenario, changes, tuple(parse_seeds(seeds)), run_all, advance)
    ladder.print_ladder(console, climbed)
    folder = out or Path("runs") / f"ladder-{climbed.scenario}"
    ladder.write_rows(climbed, folder)
    with print_style():
        write_whole(folder / "figure-ladder.png", render(draw(climbed.times, climbed.errors, goal), "png"))
    if markdown is not None:
        write_text(markdown, "\n".join(ladder.markdown(climbed)) + "\n", "--markdown")
    console.print(f"rows: {folder / ladder.ROWS}", markup=False)


@click.command()
@log_argument
@click.option("--scenario", metavar="SCENARIO", help="What was run.  [default: the shape that the log ends in]")
@options.changes
@click.option("--period", default=0.033, show_default=True, metavar="S", type=click.FloatRange(0.001, 10.0),
              help="Seconds of a turn of the loop, where the log has no times.")  # fmt: skip
@click.option("--simulate/--no-simulate", "simulated", default=True, help="Whether to simulate it from the same start.")
@click.option("--out", type=click.Path(path_type=Path), help="Run folder.  [default: runs/adopt-LOG]")
def adopt(
    log: Path, scenario: str | None, changes: tuple[str, ...], period: float, simulated: bool, out: Path | None
) -> None:
    """Make LOG, of all robots of a formation, a run folder, and simulate it beside.

    Robots stand in the order of the agents. Exit code 1 where the log did not reach the scenario's goal.
    """
    from scenarios.one_run import keep, run_to_folder
    from scenarios.studies import adoption
    from scenarios.terminal import new_console

    console = new_console()
    experiment, trajectory = adoption.adopt(log, scenario, changes, period)
    folder = out or Path("runs") / f"adopt-{log.stem}"
    reached = keep(experiment, trajectory, folder, console)
    if simulated:
        beside = folder.with_name(f"{folder.name}-simulated")
        run_to_folder(experiment, 0, beside, console)
        console.print(f"beside each other: formation replay {folder} {beside}", markup=False, soft_wrap=True)
    if not reached:
        raise SystemExit(MISSED)


@click.command()
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write to this file instead of printing.")
def calibrate(out: Path | None) -> None:
    """Write a script for the testbed that drives straight, spins, chirps and logs, for `identify`."""
    from scenarios.export.calibration import calibration
    from scenarios.storage.files import write_text

    if out is None:
        click.echo(calibration(), nl=False)
    else:
        write_text(out, calibration(), "--out")


@click.command("testbed")
@log_argument
@click.option("--seeds", default="0:20", show_default=True, metavar="A:B", help="Seeds A to B - 1 on every rung.")
@options.workers
@options.markdown("Write the page to this file instead of printing it.")
def testbed_page(log: Path, seeds: str, workers: int | None, markdown: Path | None) -> None:
    """Write the page on the testbed: the robot of LOG, the measured robot, and the paper's experiments with it."""
    from scenarios.storage.files import write_text
    from scenarios.studies import identification, ladder, testbed
    from scenarios.studies.project import PROJECT
    from scenarios.studies.sweep.seeds import parse_seeds
    from scenarios.terminal import new_console, progress_bar
    from scenarios.work.spread import spread

    found, chosen = identification.identified(log), tuple(parse_seeds(seeds))
    ladders = []
    with spread(workers, None, PROJECT) as run_all, progress_bar(new_console(), "testbed") as advance:
        ladders = [ladder.climb(name, (), chosen, run_all, advance) for name in ("shape", "maneuver-testbed")]
    page = testbed.page(found, log.name, ladders, f"formation testbed LOG --seeds {seeds} --markdown docs/testbed.md")
    if markdown is None:
        click.echo(page, nl=False)
    else:
        write_text(markdown, page, "--markdown")
