"""Commands that draw a finished run, and put its numbers into tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.cli import options
from scenarios.errors import InputError, did_you_mean, plain

if TYPE_CHECKING:
    from scenarios.documents import Sheet


TABLES = {
    "markdown": (".md", ".markdown", ".txt"),
    "latex": (".tex",),
    "csv": (".csv", ".txt"),
    "parquet": (".parquet",),
}
"""Endings of the names of files that a table may replace, by its format."""


@click.command()
@options.run_or_sweep
@options.out("Folder of the figures.  [default: RUN]")
@click.option(
    "--format", "formats", multiple=True, type=click.Choice(["png", "pdf", "svg"]), default=("png", "pdf"),
    show_default=True, help="May be given several times.",
)  # fmt: skip
@click.option(
    "--at", "at", default="", metavar="T[,T...]", show_default=False,
    help="Seconds at which the overview shows the robots.  [default: start, end, and of few phases each end]",
)  # fmt: skip
@click.option(
    "--figure", "names", multiple=True, metavar="NAME",
    help="motion, graph, decay or separation, or one panel of motion: floor or errors.  [default: the first four]",
)  # fmt: skip
@options.look
def plot(
    run_folder: Path,
    out: Path | None,
    formats: tuple[str, ...],
    at: str,
    names: tuple[str, ...],
    width: str | None,
    font: str | None,
    font_size: float | None,
) -> None:
    """Draw the paper's figures of RUN, a finished run's folder; of a script's, its overview; of a sweep's, its runs."""
    from scenarios.figures.style import look_for, print_style
    from scenarios.storage import script_folder
    from scenarios.studies.sweep.sheet import is_sweep

    times = _times(at)
    whole = is_sweep(run_folder) or script_folder.is_script(run_folder)
    for option, given in (("--figure", names), ("--at", times)):
        if given and whole:
            raise InputError(f"{option}: expected the folder of a scenario's run")
    with print_style(look_for(width, font, font_size)):
        if is_sweep(run_folder):
            _plot_sweep(run_folder, out or run_folder, formats)
        elif whole:
            _plot_script(run_folder, out, formats)
        else:
            _plot_run(run_folder, out or run_folder, formats, names, times)


@click.command()
@options.run_folder
@click.option("--format", "form", type=click.Choice(["gif", "webp", "mp4"]), default="gif", show_default=True)
@click.option("--speed", default=4.0, show_default=True, metavar="X", help="Simulated seconds per second.")
@click.option("--fps", default=20.0, show_default=True, metavar="N", help="Frames per second.")
@click.option("--width", default=720, show_default=True, metavar="PIXELS", help="Of a frame.")
@click.option("--height", type=int, metavar="PIXELS", help="Of a frame.  [default: as the floor wants]")
@options.out("Folder of the film.  [default: RUN]")
def animate(
    run_folder: Path, form: str, speed: float, fps: float, width: int, height: int | None, out: Path | None
) -> None:
    """Film RUN, the folder of a finished run, as a GIF, a WebP or an MP4; for slides, --width 1920 --height 1080."""
    from scenarios.figures import Frame
    from scenarios.figures import animate as film
    from scenarios.measures.metrics import measure
    from scenarios.storage import script_folder
    from scenarios.storage.run_folder import read
    from scenarios.terminal import new_console, progress_bar

    console, path, frame = new_console(), (out or run_folder) / f"animation.{form}", Frame(width, height)
    if script_folder.is_script(run_folder):
        from scenarios.figures.scripts.film import animate_script

        with progress_bar(console, path.name) as advance:
            animate_script(script_folder.read(run_folder), path, speed, fps, frame, advance)
        console.print(plain(str(path)), markup=False)
        return
    finished = read(run_folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    with progress_bar(console, path.name) as advance:
        film(experiment, trajectory, measure(experiment, trajectory), path, speed, fps, frame, advance)
    console.print(plain(str(path)), markup=False)


@click.command()
@click.argument(
    "folders", nargs=-1, required=True, metavar="RUN [RUN]|SWEEP", type=click.Path(path_type=Path),
    shell_complete=options.complete_run_or_sweep,
)  # fmt: skip
@click.option(
    "--format",
    "form",
    type=click.Choice(["markdown", "latex", "csv", "parquet"]),
    default="markdown",
    show_default=True,
)
@click.option("--series", is_flag=True, help="Of one run: a row per control period, units in the names.")
@click.option("--columns", metavar="NAME,...", help="Only these, in this order.  [default: all]")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write to this file instead of printing.")
def table(folders: tuple[Path, ...], form: str, series: bool, columns: str | None, out: Path | None) -> None:
    """The numbers of a run, of two runs with their differences, or of a sweep, as a table.

    Markdown and LaTeX have four digits, and no column that is empty; CSV and Parquet, which needs the extra `notebook`,
    have all.
    """
    from scenarios import documents
    from scenarios.storage.files import write_whole

    if form == "parquet" and out is None:
        raise InputError("--format parquet: needs --out, a terminal cannot show it")
    if out is not None and out.is_file() and out.suffix not in TABLES[form]:
        raise InputError(
            f"--out {out}: is there already, and by its name no table: expected {' or '.join(TABLES[form])}"
        )
    sheet = _sheet(folders, series)
    if columns is not None:
        sheet = sheet.with_columns(_columns(columns, sheet))
    elif form in ("markdown", "latex"):
        sheet = sheet.without_empty()
    if form == "parquet":
        from scenarios.interactive.frames import parquet

        content = parquet(sheet)
    else:
        content = {"markdown": documents.markdown, "latex": documents.latex, "csv": documents.csv}[form](sheet).encode()
    if out is None:
        click.echo(content.decode(), nl=False)
    else:
        write_whole(out, content, "--out")


def _columns(text: str, sheet: Sheet) -> list[str]:
    """The names of columns, in a list with commas; names of angles have commas of their own."""
    names: list[str] = []
    rest = text
    while rest:
        found = [name for name in sheet.columns if rest == name or rest.startswith(f"{name},")]
        if not found:
            wrong = rest.split(",")[0]
            raise InputError(f"--columns: no column {wrong[:40]!r}, {did_you_mean(wrong, sheet.columns)}")
        names.append(max(found, key=len))
        rest = rest[len(names[-1]) + 1 :]
    return names


def _sheet(folders: tuple[Path, ...], series: bool) -> Sheet:
    """What the folders hold, in rows and columns."""
    from scenarios.documents import Sheet
    from scenarios.measures.metrics import measure
    from scenarios.measures.result import result
    from scenarios.measures.series import series as over_time
    from scenarios.report.numbers import side_by_side
    from scenarios.storage.run_folder import read
    from scenarios.studies.sweep.sheet import is_sweep
    from scenarios.studies.sweep.sheet import sheet as of_sweep

    if len(folders) > 2:
        raise InputError(f"table: expected one run folder, two, or a sweep's, got {len(folders)}")
    if series and (len(folders) > 1 or is_sweep(folders[0])):
        raise InputError("--series: expected one run folder")
    if len(folders) == 1 and is_sweep(folders[0]):
        return of_sweep(folders[0])
    runs = [read(folder) for folder in folders]
    measured = [measure(run.experiment, run.trajectory) for run in runs]
    if series:
        columns = over_time(runs[0].experiment, runs[0].trajectory, measured[0])
        return Sheet(list(columns), list(zip(*(values.tolist() for values in columns.values()), strict=True)))
    results = [
        result(run.experiment, run.result["seed"], run.trajectory, metrics)
        for run, metrics in zip(runs, measured, strict=True)
    ]
    names = [folder.resolve().name for folder in folders]
    return side_by_side(names if len(set(names)) == len(names) else [str(folder) for folder in folders], results)


def _times(text: str) -> list[float]:
    """Comma-separated seconds."""
    try:
        return [float(part) for part in text.split(",")] if text else []
    except ValueError:
        raise InputError(f"--at: expected seconds, separated by commas, got {text[:40]!r}") from None


def _plot_run(
    folder: Path, out: Path, formats: tuple[str, ...], names: tuple[str, ...], times: Sequence[float]
) -> None:
    from scenarios.figures import names_for
    from scenarios.figures import plot as draw
    from scenarios.measures.metrics import measure
    from scenarios.storage.run_folder import read
    from scenarios.terminal import new_console

    finished = read(folder)
    experiment, trajectory = finished.experiment, finished.trajectory
    metrics = measure(experiment, trajectory)
    console = new_console()
    for path in draw(experiment, trajectory, metrics, out, names or names_for(experiment), formats, times):
        console.print(plain(str(path)), markup=False)


def _plot_sweep(folder: Path, out: Path, formats: tuple[str, ...]) -> None:
    from scenarios.figures.studies.dependence import dependence
    from scenarios.figures.style import render
    from scenarios.storage.files import write_whole
    from scenarios.studies.sweep.sheet import groups
    from scenarios.terminal import new_console

    found = groups(folder)
    figure = dependence(found.key, found.labels, found.shares, found.values)
    console = new_console()
    for form in formats:
        path = out / f"figure-sweep.{form}"
        write_whole(path, render(figure, form))
        console.print(plain(str(path)), markup=False)


def _plot_script(run_folder: Path, out: Path | None, formats: tuple[str, ...]) -> None:
    from scenarios.figures.scripts.overview import draw_overview
    from scenarios.storage import script_folder
    from scenarios.terminal import new_console

    console = new_console()
    for path in draw_overview(script_folder.read(run_folder), out or run_folder, formats):
        console.print(plain(str(path)), markup=False)
