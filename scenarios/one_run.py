"""One run from an experiment to its run folder, with a progress bar and the printed result."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape

from scenarios.definition.experiment import Experiment
from scenarios.errors import plain
from scenarios.measures.metrics import Metrics, measure
from scenarios.measures.predictions.remarks import remarks
from scenarios.measures.result import result
from scenarios.recording import aside, viewer
from scenarios.report.result import print_result
from scenarios.simulation.compiling import compile_for
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage import run_folder
from scenarios.terminal import progress_bar

if TYPE_CHECKING:
    from scenarios.recording.live import LiveView
    from scenarios.recording.viewer import Live


def run_to_folder(
    experiment: Experiment,
    seed: int,
    out: Path | None,
    console: Console,
    recorded: bool = True,
    live: Live | None = None,
) -> bool:
    """Run, write the run folder, print the result.

    Args:
        experiment: what to run.
        seed: of the run.
        out: the run folder; None for the default.
        console: where the result is printed.
        recorded: whether the folder gets a recording.
        live: how a viewer watches the run; None for no viewer.

    Returns:
        Whether the run reached its goal.

    Raises:
        InputError: the folder cannot be written; known before the run starts.
    """
    for remark in remarks(experiment, seed):
        console.print(escape(remark), style="bold")
    folder = out or run_folder.default_path(experiment.file.name, experiment.plant, seed)
    with run_folder.writing(folder) as scratch:
        view = _open_view(experiment, seed, live, console)
        compile_for(experiment)
        with progress_bar(console, experiment.file.name) as advance:
            trajectory = simulate(experiment, seed, advance, view)
        metrics = measure(experiment, trajectory)
        summary = result(experiment, seed, trajectory, metrics)
        _fill(scratch, experiment, trajectory, metrics, summary, recorded, console)
    _close_view(view, live, summary, console)
    print_result(console, summary)
    console.print(f"run folder: {escape(plain(str(folder)))}")
    return metrics.outcome == "converged"


def keep(experiment: Experiment, trajectory: Trajectory, folder: Path, console: Console) -> bool:
    """Make a run folder of a trajectory that something else than the simulation gave, and print its result.

    Returns:
        Whether it reached the experiment's goal.

    Raises:
        InputError: the folder cannot be written.
    """
    metrics = measure(experiment, trajectory)
    summary = result(experiment, 0, trajectory, metrics)
    save(experiment, trajectory, metrics, summary, folder, console)
    print_result(console, summary)
    console.print(f"run folder: {escape(plain(str(folder)))}")
    return metrics.outcome == "converged"


def save(
    experiment: Experiment,
    trajectory: Trajectory,
    metrics: Metrics,
    summary: dict[str, Any],
    folder: Path,
    console: Console,
) -> None:
    """Write the run folder of a run that is made, with its recording.

    Raises:
        InputError: the folder cannot be written.
    """
    with run_folder.writing(folder) as scratch:
        _fill(scratch, experiment, trajectory, metrics, summary, True, console)


def _fill(
    scratch: Path,
    experiment: Experiment,
    trajectory: Trajectory,
    metrics: Metrics,
    summary: dict[str, Any],
    recorded: bool,
    console: Console,
) -> None:
    """All files of a run folder."""

    def encoded() -> bytes:
        from scenarios.recording.encode import encode  # loads rerun

        return encode(experiment, trajectory, metrics, summary)

    run_folder.write(scratch, experiment, trajectory, metrics.angle_errors, summary)
    path = scratch / run_folder.RECORDING
    with aside.recording(path, encoded, console) if recorded else nullcontext():
        _draw_overview(experiment, trajectory, metrics, scratch)


def _draw_overview(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, folder: Path) -> None:
    from scenarios.figures import OVERVIEW, plot  # matplotlib takes as long to load as the run takes

    plot(experiment, trajectory, metrics, folder, [OVERVIEW], ["png"])  # `formation plot` draws the rest, and for print


def _open_view(experiment: Experiment, seed: int, live: Live | None, console: Console) -> LiveView | None:
    """The viewer that watches the run; None where none is wanted or there is none: the run goes on without."""
    if live is None:
        return None
    if not viewer.ready(live.port):
        console.print("live: no viewer, and none can be started here; the run goes on without")
        return None
    from scenarios.recording.live import LiveView, viewer_at

    return LiveView(experiment, seed, viewer_at(live.port), live.speed)


def _close_view(view: LiveView | None, live: Live | None, summary: dict[str, Any], console: Console) -> None:
    if view is not None and live is not None and not (view.finish(summary) and viewer.listening(live.port)):
        console.print("live: the viewer went away; the run folder has everything")
