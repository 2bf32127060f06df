"""One run of a script for the Robotarium, to its run folder."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.markup import escape

from robots.measured import MEASURED
from robots.model import CONTROL_PERIOD
from robots.rps.robotarium import Robotarium
from robots.rps.session import Session, Start
from robots.rps.simulation import WHEELED
from robots.worlds import MEASURED_PLANTS
from scenarios.errors import InputError, did_you_mean
from scenarios.measures.script_result import chosen, script_result
from scenarios.recording import aside, viewer
from scenarios.report.script_printout import print_script, print_script_result
from scenarios.simulation.script.execute import Ending, execute
from scenarios.simulation.script.frames import FINAL_DOTS_PER_INCH, Camera, all_drawn, png
from scenarios.simulation.script.screen import take_the_screen_away
from scenarios.simulation.script.script_file import ScriptFile
from scenarios.storage import run_folder, script_folder
from scenarios.terminal import open_ended

if TYPE_CHECKING:
    from scenarios.recording.script_live import ScriptView

FIGURE = "figure"
"""Name of the script's first figure in the folder; the others are numbered from 2."""


@dataclass(frozen=True)
class Settings:
    """How a script is run.

    Attributes:
        plant: one of :data:`robots.rps.simulation.WHEELED`.
        seed: of the generators that scripts draw from.
        start: how robots come to their initial conditions.
        duration: simulated seconds after which it is stopped; None for never.
        recorded: whether the folder gets a recording.
        live: whether a viewer watches.
        on_screen: whether the script's figures are shown while it runs.
        measured: whether the robots are as logs and firmware show them.

    Raises:
        InputError: there is no such plant, or it has no measured robots.
    """

    plant: str = "pymunk"
    seed: int = 0
    start: Start = "exact"
    duration: float | None = None
    recorded: bool = True
    live: bool = False
    on_screen: bool = False
    measured: bool = False

    def __post_init__(self) -> None:
        if self.plant not in WHEELED:
            raise InputError(f"--plant {self.plant}: scripts need wheels, {did_you_mean(self.plant, WHEELED)}")
        if self.measured and self.plant not in MEASURED_PLANTS:
            raise InputError(f"--measured: robots move on {' and '.join(MEASURED_PLANTS)}, got --plant {self.plant}")


def run_script(
    file: ScriptFile, arguments: Sequence[str], settings: Settings, out: Path | None, console: Console
) -> tuple[Ending, bool]:
    """Run a script, write its run folder, print the result.

    However the script ends, the folder has what its robots did until then.

    Returns:
        How it ended, and whether the testbed would accept it.

    Raises:
        InputError: the folder cannot be written; known before the script starts. Or the script has made no robots.
    """
    folder = (out or script_folder.default_path(file.name, settings.plant, settings.seed)).absolute()
    if not settings.on_screen:
        take_the_screen_away()
    with run_folder.writing(folder) as scratch:
        print_script(console, file)
        camera, view = Camera(), _open_view(settings, file, console)
        with open_ended(console, file.name) as say, _folder_kept():
            ending = execute(
                file, arguments, _session(settings, console, camera, view, say), settings.seed, settings.duration
            )
        _print_end(ending, console)
        robots = chosen(ending.robots)
        if robots is None:
            raise InputError(f"{file.path}: made no robots, so that there is nothing to keep{_why(ending)}")
        result = script_result(file, arguments, settings.seed, settings.start, settings.plant, ending, robots)
        result["robot_model"] = "measured" if settings.measured else "nominal"
        script_folder.write(scratch, file.source, robots.record(), camera.frames(robots), result)
        with _recording(scratch, console) if settings.recorded else nullcontext():
            _draw(scratch, robots)
    if view is not None and not view.finish():
        console.print("live: the viewer went away; the run folder has everything")
    print_script_result(console, robots.record(), result)
    console.print(f"run folder: {escape(_shown(folder))}")
    return ending, result["testbed"]["accepted"]


def _session(
    settings: Settings, console: Console, camera: Camera, view: ScriptView | None, say: Callable[[str], None]
) -> Session:
    def begun(robots: Robotarium) -> None:
        if view is not None:
            view.begin(robots)

    def stepped(robots: Robotarium) -> None:
        camera.look(robots)
        say(f"{robots.steps * CONTROL_PERIOD:.1f} s simulated")
        if view is not None:
            view.look(robots)

    told = set[str]()

    def tell(text: str) -> None:
        if text not in told:
            told.add(text)
            console.print(escape(f"note: {text}"))

    return Session(
        settings.plant,
        settings.start,
        np.random.default_rng(settings.seed),
        begun,
        stepped,
        tell,
        settings.on_screen,
        MEASURED if settings.measured else None,
    )


@contextmanager
def _folder_kept() -> Iterator[None]:
    """Come back to the folder in which we are: scripts may go elsewhere."""
    here = Path.cwd()
    try:
        yield
    finally:
        os.chdir(here)


def _print_end(ending: Ending, console: Console) -> None:
    if ending.text:
        console.print(escape(ending.text))


def _why(ending: Ending) -> str:
    last = ending.text.splitlines()[-1] if ending.text else ""
    advice = f"; {ending.advice}" if ending.advice else ""
    return f": {last}{advice}" if last else ""


def _draw(folder: Path, robots: Robotarium) -> None:
    """The overview, and the script's figures as it has left them."""
    for number, figure in enumerate(all_drawn(robots), start=1):
        name = FIGURE if number == 1 else f"{FIGURE}-{number}"
        with suppress(Exception):  # what a script has made of its figure may not be drawable
            (folder / f"{name}.png").write_bytes(png(figure, FINAL_DOTS_PER_INCH))
    from scenarios.figures.scripts.overview import draw_overview

    draw_overview(script_folder.read(folder), folder, ["png"])


def _recording(folder: Path, console: Console) -> AbstractContextManager[None]:
    """Records the run in ``folder``, which has all other files, beside what the block does."""

    def encoded() -> bytes:
        from scenarios.recording.script import encode_script  # loads rerun

        return encode_script(script_folder.read(folder))

    return aside.recording(folder / run_folder.RECORDING, encoded, console)


def _open_view(settings: Settings, file: ScriptFile, console: Console) -> ScriptView | None:
    """The viewer that watches the run; None where there is none, and then the run goes on without."""
    if not settings.live:
        return None
    if not viewer.ready(viewer.PORT):
        console.print("live: no viewer, and none can be started here; the run goes on without")
        return None
    from scenarios.recording.live import viewer_at
    from scenarios.recording.script_live import ScriptView

    return ScriptView(file, settings.plant, settings.seed, viewer_at(viewer.PORT))


def _shown(folder: Path) -> str:
    """A folder as people wrote it, where it is below the one they are in."""
    here = Path.cwd()
    return str(folder.relative_to(here)) if folder.is_relative_to(here) else str(folder)
