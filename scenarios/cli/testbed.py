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
    from scenarios.figures.residuals import residuals
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
