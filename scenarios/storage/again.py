"""A run once more from its folder, bit for bit, and a run that begins where another one ended."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.definition.experiment import Experiment, build
from scenarios.definition.files import law_file
from scenarios.definition.load import ScenarioFile, library, validate, with_changes
from scenarios.errors import InputError
from scenarios.storage import run_folder


def is_recorded(source: str) -> bool:
    """Whether a scenario's name or path is that of a run folder or of the scenario in one; library names come first."""
    return source not in library() and (Path(source).name == run_folder.SCENARIO or os.path.isdir(source))


def open_again(source: str, changes: tuple[str, ...], duration: float | None) -> tuple[Experiment, int]:
    """The experiment of a run folder, or of the ``scenario.json`` in it, with the law that was run; and its seed.

    Args:
        source: path of either.
        changes: ``key=value`` texts, on top of what was run.
        duration: seconds in place of what was run; None for the same.

    Raises:
        InputError: the folder holds no run, or one that was edited; or a change cannot be used.
    """
    path = Path(source)
    folder = path.parent if path.name == run_folder.SCENARIO else path
    if not (folder / run_folder.RESULT).is_file():
        raise InputError(f"{source}: neither a scenario nor a run folder, it holds no {run_folder.RESULT}")
    file, result = run_folder.read_recipe(folder)
    if changes:
        file = _changed(folder, file, changes)
    asked = run_folder.asked_duration(file.scenario, result) if duration is None else duration
    return build(file, asked), result.seed


def notice(source: str, before: int, seed: int | None, changes: tuple[str, ...], duration: float | None) -> str:
    """One line that tells what is run again, and what is not as it was."""
    other = [] if seed in (None, before) else [f"seed {seed} in place of {before}"]
    other += [*changes, *([] if duration is None else [f"{duration:g} s"])]
    return f"again: {source}, " + (f"but with {', '.join(other)}" if other else f"seed {before}, nothing changed")


def begin_where(experiment: Experiment, folder: Path) -> Experiment:
    """The experiment with the last points and headings of a run as its start.

    They stand in its scenario, so that its own run folder tells the whole. A random formation becomes a list of agents.

    Raises:
        InputError: the folder holds no run that can be read, one of another number of agents, or one that diverged.
    """
    run = run_folder.read(folder)
    if run.experiment.n != experiment.n:
        raise InputError(
            f"--start-from {folder}: that run has {run.experiment.n} agents, "
            f"expected {experiment.n} as {experiment.file.path} has"
        )
    points, headings = run.trajectory.points[-1], run.trajectory.poses[-1, :, 2]
    if not (np.isfinite(points).all() and np.isfinite(headings).all()):
        raise InputError(f"--start-from {folder}: that run diverged, its end is no place to start from")
    content = experiment.scenario.model_dump(mode="json")
    if experiment.scenario.random_formation is not None:
        content |= {"random_formation": None, "agents": _agents(experiment)}
        if experiment.scenario.graph == "design":
            content["graph"] = "subgraph"
    content["random_start"] = None
    for agent in content["agents"]:
        row = experiment.numbers.index(agent["id"])
        agent["start"] = points[row].tolist()
        agent["heading_deg"] = float(np.degrees(np.mod(headings[row], 2.0 * np.pi)))
    file = experiment.file
    scenario = validate(content, f"--start-from {folder}: {file.path}")
    return build(replace(file, scenario=scenario), experiment.asked_duration)


def _agents(experiment: Experiment) -> list[dict[str, Any]]:
    """The agents of a random formation as a scenario lists them."""
    senses: list[list[int]] = [[] for _ in range(experiment.n)]
    for observer, observed in experiment.graph.edges.tolist():
        senses[observer].append(experiment.number(observed))
    return [
        {"id": experiment.number(row), "neighbours": senses[row], "target": experiment.target.positions[row].tolist()}
        for row in range(experiment.n)
    ]


def _changed(folder: Path, file: ScenarioFile, changes: tuple[str, ...]) -> ScenarioFile:
    scenario = validate(with_changes(file.scenario.model_dump(mode="json"), changes), file.path)
    law, name = file.law, scenario.law.file
    if name != file.scenario.law.file:
        law = None if name is None else law_file.read(file.path, folder, name)
    return replace(file, scenario=scenario, law=law)
