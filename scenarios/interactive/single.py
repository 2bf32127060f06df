"""A run as a value: its numbers, its frame, its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal

from scenarios.definition.experiment import Experiment, open_experiment, require_safety
from scenarios.definition.load import changed
from scenarios.errors import InputError
from scenarios.interactive.film import Film
from scenarios.interactive.frames import pandas
from scenarios.measures.metrics import Metrics, measure
from scenarios.measures.result import result
from scenarios.measures.series import series
from scenarios.simulation.compiling import compile_for
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

WIDTH = 100
"""Characters of a line of a result in a notebook."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """A finished run.

    Attributes:
        experiment: what was run.
        seed: of all its randomness.
        trajectory: its states.
        metrics: what it achieved.
    """

    experiment: Experiment
    seed: int
    trajectory: Trajectory
    metrics: Metrics

    @cached_property
    def result(self) -> dict[str, Any]:
        """The content of ``result.json``."""
        return result(self.experiment, self.seed, self.trajectory, self.metrics)

    def table(self) -> DataFrame:
        """A row per control period, units in the names of the columns: :func:`scenarios.measures.series.series`.

        Raises:
            InputError: pandas is missing.
        """
        return pandas().DataFrame(series(self.experiment, self.trajectory, self.metrics))

    def plot(
        self,
        name: str = "motion",
        *,
        at: Sequence[float] = (),
        width: str | None = None,
        font: str | None = None,
        font_size: float | None = None,
    ) -> Figure:
        """A figure of ``formation plot`` for one column of a paper: motion, graph, decay or separation.

        ``floor`` and ``errors`` are the panels of motion.

        Args:
            name: of the figure.
            at: times, seconds, at which motion shows the robots; start and end, and of few phases each end, if none.
            width: instead of a column's, ``7in`` or ``180mm``, say.
            font: ``serif``, ``sans`` or a family's name.
            font_size: points, of labels and titles.

        Raises:
            InputError: there is none of that name, a time is not one of the run, or one cannot look so.
        """
        from scenarios.figures import draw  # loads matplotlib
        from scenarios.figures.style import look_for, print_style

        with print_style(look_for(width, font, font_size)):
            return draw(self.experiment, self.trajectory, self.metrics, name, at)

    def animate(
        self,
        form: Literal["gif", "webp", "mp4"] = "gif",
        speed: float = 4.0,
        fps: float = 20.0,
        width: int = 720,
        height: int | None = None,
    ) -> Film:
        """The film of ``formation animate``, which a notebook plays.

        Args:
            form: of its bytes.
            speed: simulated seconds per second.
            fps: frames per second.
            width, height: pixels; without a height, as high as the floor wants.

        Raises:
            InputError: one of them is out of range.
        """
        from scenarios.figures import Frame, animate  # loads matplotlib

        with TemporaryDirectory() as folder:
            path = Path(folder) / f"animation.{form}"
            frame, quiet = Frame(width, height), lambda done, total: None
            animate(self.experiment, self.trajectory, self.metrics, path, speed, fps, frame, quiet)
            return Film(path.read_bytes(), form)

    def replay(self, width: int = 960, height: int = 600) -> Any:
        """The recording of ``formation replay``, in the viewer inside a notebook.

        Args:
            width, height: pixels.

        Raises:
            InputError: rerun's package for notebooks is missing.
        """
        from scenarios.interactive.viewer import widget
        from scenarios.recording.encode import encode  # loads rerun

        recording = encode(self.experiment, self.trajectory, self.metrics, self.result)
        return widget(recording, width, height)

    def save(self, folder: str | Path) -> Path:
        """Write the run folder that ``formation run`` writes, for ``replay``, ``plot``, ``animate`` and ``run RUN``.

        Raises:
            InputError: the folder cannot be written, or holds what no run wrote.
        """
        from scenarios.one_run import save  # loads the recorder
        from scenarios.terminal import new_console

        save(self.experiment, self.trajectory, self.metrics, self.result, Path(folder), new_console())
        return Path(folder)

    def __repr__(self) -> str:
        return (
            f"<run of {self.experiment.file.name}, {self.experiment.plant}, seed {self.seed}: {self.metrics.outcome}>"
        )

    def _repr_html_(self) -> str:
        """What ``formation run`` prints."""
        from rich.console import Console

        from scenarios.report.result import print_result

        console = Console(file=StringIO(), record=True, highlight=False, width=WIDTH, force_jupyter=False)
        print_result(console, self.result)
        return console.export_html(inline_styles=True, code_format="<pre>{code}</pre>")


def run(
    scenario: str | Path,
    changes: Sequence[str] = (),
    *,
    seed: int = 0,
    plant: str | None = None,
    safety: str | None = None,
    duration: float | None = None,
) -> Run:
    """Run a scenario, as ``formation run`` does, without a file.

    Args:
        scenario: a library name or a path.
        changes: ``key=value`` texts, as with ``--set``.
        seed: of all randomness.
        plant, safety: instead of the scenario's own.
        duration: seconds to run instead of the scenario's own.

    Raises:
        InputError: the scenario cannot be used.
    """
    if seed < 0:
        raise InputError(f"seed: expected an integer from 0, got {seed}")
    experiment = open_experiment(str(scenario), changed(tuple(changes), plant, safety), duration)
    require_safety(experiment, safety)
    compile_for(experiment)
    trajectory = simulate(experiment, seed)
    return Run(experiment, seed, trajectory, measure(experiment, trajectory))
