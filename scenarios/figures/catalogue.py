"""Which figures there are, which of them make sense for a run, and their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np
from matplotlib.figure import Figure

from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError, did_you_mean
from scenarios.figures.decay import decay
from scenarios.figures.graphs import graph
from scenarios.figures.motion import errors, floor, motion, rows_at
from scenarios.figures.separation import separation
from scenarios.figures.style import print_style, render
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import write_whole

FIGURES = MappingProxyType({"graph": graph, "motion": motion, "decay": decay, "separation": separation})
"""Each figure by name: a function of the experiment, the trajectory and the metrics of a run."""

PANELS = MappingProxyType({"floor": floor, "errors": errors})
"""Parts of the overview by themselves, drawn where they are asked for."""

OVERVIEW = "motion"
"""The figure that every run leaves in its folder."""

TIMED = MappingProxyType({OVERVIEW: motion, "floor": floor})
"""Those that show robots at times."""

Draw = Callable[[Experiment, Trajectory, Metrics], Figure]


def names_for(experiment: Experiment) -> list[str]:
    """Names of the figures that make sense: no decay rates for a law that has none, no separation without bodies."""
    without = set()
    if experiment.scenario.law.name != "angle":
        without.add("decay")
    if experiment.plant == "single_integrator":
        without.add("separation")
    return [name for name in FIGURES if name not in without]


@np.errstate(over="ignore", invalid="ignore")  # a diverged run has a figure too
def draw(
    experiment: Experiment, trajectory: Trajectory, metrics: Metrics, name: str, at: Sequence[float] = ()
) -> Figure:
    """A figure by its name, in the style of print; on the floor are the robots ``at`` times, seconds, if given.

    Raises:
        InputError: there is none of that name, or a time is not one of the run.
    """
    drawn = {**FIGURES, **PANELS}
    if name not in drawn:
        raise InputError(f"figure {name[:40]!r}: {did_you_mean(name, drawn)}")
    with print_style():
        if name in TIMED:
            return TIMED[name](experiment, trajectory, metrics, at)
        make: Draw = drawn[name]
        return make(experiment, trajectory, metrics)


@np.errstate(over="ignore", invalid="ignore")  # a diverged run has a figure too
def plot(
    experiment: Experiment,
    trajectory: Trajectory,
    metrics: Metrics,
    folder: Path,
    names: Iterable[str],
    formats: Iterable[str],
    at: Sequence[float] = (),
) -> list[Path]:
    """Draw figures into ``folder`` as ``figure-NAME.FORMAT``, each file whole or not at all; see :func:`draw`.

    Returns:
        The files, in the order of ``names`` and ``formats``.

    Raises:
        InputError: the folder cannot be written, or a time is not one of the run.
    """
    rows_at(trajectory, at)  # before anything is drawn
    written = []
    with print_style(), np.errstate(over="ignore", invalid="ignore"):  # a diverged run is an outcome, not a warning
        for name in names:
            figure = draw(experiment, trajectory, metrics, name, at)
            for form in formats:
                path = folder / f"figure-{name}.{form}"
                write_whole(path, render(figure, form))
                written.append(path)
    return written
