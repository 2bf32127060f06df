"""One run from an experiment to its run folder, with a progress bar and the printed result."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.markup import escape

from scenarios import run_folder
from scenarios.experiment import Experiment
from scenarios.metrics import Metrics, measure
from scenarios.report import print_result
from scenarios.result import result
from scenarios.simulation import simulate
from scenarios.terminal import progress_bar
from scenarios.trajectory import Trajectory


def run_to_folder(experiment: Experiment, seed: int, out: Path | None, console: Console) -> bool:
    """Run, write the run folder, print the result.

    Returns:
        Whether the run reached its goal.

    Raises:
        InputError: the folder cannot be written; known before the run starts.
    """
    folder = out or run_folder.default_path(experiment.file.name, experiment.plant, seed)
    with run_folder.writing(folder) as scratch:
        with progress_bar(console, experiment.file.name) as advance:
            trajectory = simulate(experiment, seed, advance)
        metrics = measure(experiment, trajectory)
        summary = result(experiment, seed, trajectory, metrics)
        trajectory.save(scratch / run_folder.TRAJECTORY, metrics.angle_errors)
        run_folder.write_json(scratch / run_folder.SCENARIO, experiment.scenario.model_dump(mode="json"))
        run_folder.write_json(scratch / run_folder.RESULT, summary)
        _draw_overview(experiment, trajectory, metrics, scratch)
    print_result(console, summary)
    console.print(f"run folder: {escape(str(folder))}")
    return metrics.outcome == "converged"


def _draw_overview(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, folder: Path) -> None:
    from scenarios.figures import OVERVIEW, plot  # matplotlib takes as long to load as the run takes

    plot(experiment, trajectory, metrics, folder, [OVERVIEW], ["png", "pdf"])
