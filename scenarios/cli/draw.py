"""Commands that draw a finished run."""

from __future__ import annotations

from pathlib import Path

import click

from scenarios.cli import options
from scenarios.errors import plain


@click.command()
@options.run_folder
@options.out("Folder of the figures.  [default: RUN]")
@click.option(
    "--format", "formats", multiple=True, type=click.Choice(["png", "pdf", "svg"]), default=("png", "pdf"),
    show_default=True, help="May be given several times.",
)  # fmt: skip
def plot(run_folder: Path, out: Path | None, formats: tuple[str, ...]) -> None:
    """Draw the paper's figures of RUN, the folder of a finished run; of a script's run, its overview."""
    from scenarios.storage import script_folder

    if script_folder.is_script(run_folder):
        _plot_script(run_folder, out, formats)
        return
    from scenarios.figures import names_for
    from scenarios.figures import plot as draw
    from scenarios.measures.metrics import measure
    from scenarios.storage.run_folder import read
    from scenarios.terminal import new_console

    finished = read(run_folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    metrics = measure(experiment, trajectory)
    console = new_console()
    for path in draw(experiment, trajectory, metrics, out or run_folder, names_for(experiment), formats):
        console.print(plain(str(path)), markup=False)


@click.command()
@options.run_folder
@click.option("--format", "form", type=click.Choice(["gif", "mp4"]), default="gif", show_default=True)
@click.option("--speed", default=4.0, show_default=True, metavar="X", help="Simulated seconds per second.")
@click.option("--fps", default=20.0, show_default=True, metavar="N", help="Frames per second.")
@options.out("Folder of the film.  [default: RUN]")
def animate(run_folder: Path, form: str, speed: float, fps: float, out: Path | None) -> None:
    """Film RUN, the folder of a finished run, as a GIF or an MP4."""
    from scenarios.figures import animate as film
    from scenarios.measures.metrics import measure
    from scenarios.storage import script_folder
    from scenarios.storage.run_folder import read
    from scenarios.terminal import new_console, progress_bar

    console, path = new_console(), (out or run_folder) / f"animation.{form}"
    if script_folder.is_script(run_folder):
        from scenarios.figures.scripts.film import animate_script

        with progress_bar(console, path.name) as advance:
            animate_script(script_folder.read(run_folder), path, speed, fps, advance)
        console.print(plain(str(path)), markup=False)
        return
    finished = read(run_folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    with progress_bar(console, path.name) as advance:
        film(experiment, trajectory, measure(experiment, trajectory), path, speed, fps, advance)
    console.print(plain(str(path)), markup=False)


def _plot_script(run_folder: Path, out: Path | None, formats: tuple[str, ...]) -> None:
    from scenarios.figures.scripts.overview import draw_overview
    from scenarios.storage import script_folder
    from scenarios.terminal import new_console

    console = new_console()
    for path in draw_overview(script_folder.read(run_folder), out or run_folder, formats):
        console.print(plain(str(path)), markup=False)
