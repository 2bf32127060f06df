"""Commands that ask the testbed itself: a log of a real robot."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options

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
