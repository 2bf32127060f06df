"""The run folder: written whole or not at all, and read back."""

from __future__ import annotations

import errno
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenarios.definition.files.reading import read_json
from scenarios.errors import InputError
from scenarios.storage import manifest, scratch
from scenarios.storage.files import write_json

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenarios.definition.experiment import Experiment
    from scenarios.definition.load import ScenarioFile
    from scenarios.definition.schema import Scenario
    from scenarios.simulation.trajectory import Trajectory
    from scenarios.storage.result_schema import Result

RESULT = "result.json"
TRAJECTORY = "trajectory.npz"
RECORDING = "recording.rrd"
SCENARIO = "scenario.json"
"""The validated scenario, with all changes of the command line: what replay and plots need besides the states."""
LAW = "law.py"
"""The own law of the run, as it was when the run was made."""


@dataclass(frozen=True, eq=False)
class Run:
    """A finished run, as its folder holds it.

    Attributes:
        folder: where it was read from.
        experiment: what was run, rebuilt from the scenario with all changes of the command line.
        trajectory: the recorded states.
        result: the content of ``result.json``.
    """

    folder: Path
    experiment: Experiment
    trajectory: Trajectory
    result: dict[str, Any]


def default_path(scenario: str, plant: str, seed: int) -> Path:
    """Where a run goes when no folder is named."""
    return Path("runs") / f"{scenario}-{plant}-seed{seed}"


@contextmanager
def writing(folder: Path) -> Iterator[Path]:
    """A scratch folder beside ``folder`` that takes its place when the block ends well and vanishes when it does not.

    Entering proves that the place can be written, before anything is computed. An older run in the same place is
    replaced, where everything in it is as the project wrote it; anything else is left alone.

    Raises:
        InputError: the place cannot be written, now or later (a full disk), another process is writing it, or it holds
            something that no run wrote. Where that came while the block ran, what the block made is kept beside it.
    """
    try:
        place = Path(os.path.realpath(folder))  # what a link points to is replaced, not the link
        if (reason := _taken(place)) is not None:
            raise InputError(f"--out {folder}: {reason}; move it, or name another folder")
        with scratch.beside(place, exclusive=True) as room:
            new = room / "new"
            new.mkdir()
            yield new
            manifest.write(new)
            if (reason := _take(place, new, room)) is not None:
                kept = _keep_beside(place, new)
                raise InputError(f"--out {folder}: {reason}, and was left alone; the run is kept in {kept}")
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from error


def _taken(place: Path) -> str | None:
    """Why nothing may stand in a place, in words for a message; None where it is free or holds a run alone."""
    try:
        os.lstat(place)
    except FileNotFoundError:
        return None
    if not place.is_dir():
        return "exists and is not a run folder"
    scratch.sweep(place)
    return manifest.foreign(place)


def _take(place: Path, new: Path, room: Path) -> str | None:
    """Put the folder ``new`` in its place, and what the place held aside; why that must not be, else None."""
    if (reason := _taken(place)) is not None:
        return reason
    aside = room / scratch.ASIDE / place.name
    if place.exists():
        aside.parent.mkdir()
        os.replace(place, aside)  # whole, so that no half-deleted folder ever stands in its place
        if (reason := manifest.foreign(aside)) is not None:
            os.replace(aside, place)
            return reason
    try:
        os.replace(new, place)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
            raise
        return "appeared while the run was under way"
    return None


def _keep_beside(place: Path, new: Path) -> Path:
    """Put the folder ``new`` beside a place that is taken."""
    number = 2
    while True:
        beside = place.with_name(f"{place.name}-{number}")
        try:
            beside.mkdir()
        except FileExistsError:
            number += 1
        else:
            os.replace(new, beside)
            return beside


def is_run(folder: Path) -> bool:
    """Whether ``folder`` holds a finished run, and not one that is under way or was killed."""
    return _looks_like_run(folder) and not scratch.is_scratch(folder)


def _looks_like_run(folder: Path) -> bool:
    return os.path.isfile(folder / RESULT) and os.path.isfile(folder / TRAJECTORY)  # of any path that can be given


def read(folder: Path) -> Run:
    """Read a run folder back, and check all that is read.

    Raises:
        InputError: it is not a run folder, or one of its files is missing, damaged, edited or of another run.
    """
    # The command line imports this module before it knows its command; only reading needs the whole experiment.
    from scenarios.definition.experiment import build
    from scenarios.storage import states

    if not os.path.exists(folder):
        raise InputError(f"{folder}: no such run folder")
    if not _looks_like_run(folder):
        raise InputError(f"{folder}: not a run folder, it holds no {RESULT} and {TRAJECTORY}")
    if scratch.is_scratch(folder):
        raise InputError(f"{folder}: not a finished run, its process still works or was killed; make the run again")
    file, result = read_recipe(folder)
    experiment = build(file, asked_duration(file.scenario, result), to_run=False)
    for key, recorded, expected in (
        ("plant", result.plant, experiment.plant),
        ("safety", result.safety, experiment.safety),
        ("goal_rad", result.goal_rad, experiment.goal),
        ("angles", [angle.name for angle in result.angles], list(experiment.angle_names)),
    ):
        if recorded != expected:
            raise InputError(f"{folder / RESULT}: {key}: expected {expected!r} as in {SCENARIO}, got {recorded!r:.80}")
    planned = sum(phase.duration for phase in experiment.phases)
    if not math.isclose(result.planned_duration_s, planned):
        raise InputError(
            f"{folder / RESULT}: planned_duration_s: expected {planned:g}, got {result.planned_duration_s:g}"
        )
    trajectory = states.read(folder / TRAJECTORY, experiment, result.seed)
    if trajectory.t[-1] != result.duration_s:
        raise InputError(
            f"{folder / TRAJECTORY}: t: expected {result.duration_s!r} s at the end as in {RESULT}, "
            f"got {float(trajectory.t[-1])!r}"
        )
    for name in (RESULT, TRAJECTORY):
        if manifest.changed(folder / name):
            raise InputError(f"{folder / name}: changed since the run wrote it ({manifest.NAME}); make the run again")
    return Run(folder, experiment, trajectory, read_json(folder / RESULT))


def read_recipe(folder: Path) -> tuple[ScenarioFile, Result]:
    """What a run was made from, and what is read of its result.

    Raises:
        InputError: the folder holds neither, or they were edited.
    """
    from scenarios.storage import result_schema

    result = result_schema.check(folder / RESULT, read_json(folder / RESULT))
    return _read_scenario(folder, result), result


def _read_scenario(folder: Path, result: Result) -> ScenarioFile:
    """The scenario of a run, as it was when the run was made.

    Raises:
        InputError: it cannot be used, or is another one.
    """
    from scenarios.definition.digest import digest
    from scenarios.definition.files import law_file
    from scenarios.definition.load import ScenarioFile, validate

    path = folder / SCENARIO
    content = read_json(path)
    scenario = validate(content, str(path))
    law = None
    if scenario.law.file is not None:
        if scenario.law.file != LAW:
            raise InputError(f"{path}: law.file: expected {LAW!r}, in the run folder, got {scenario.law.file!r:.80}")
        law = law_file.read(str(path), folder, LAW)
    if digest(content, law) != result.scenario_sha256:
        raise InputError(f"{path}: not what {RESULT} says was run (scenario_sha256): edited since, or of another run")
    return ScenarioFile(result.scenario, str(path), "", scenario, law)


def asked_duration(scenario: Scenario, result: Result) -> float | None:
    """The seconds of a run that replaced the scenario's own; None where none did."""
    if result.asked_duration_s is not None:
        return result.asked_duration_s
    own = sum(phase.duration_s for phase in scenario.phases) or scenario.duration_s
    return None if own == result.planned_duration_s else result.planned_duration_s


def write(
    folder: Path,
    experiment: Experiment,
    trajectory: Trajectory,
    angle_errors: NDArray[np.float64],
    result: dict[str, Any],
) -> None:
    """Write what :func:`read` needs, so that the folder needs nothing outside it.

    Args:
        folder: that :func:`writing` gave.
        experiment: what was run.
        trajectory: its states.
        angle_errors: (T, m) radians, kept beside the states.
        result: the content of ``result.json``.
    """
    trajectory.save(folder / TRAJECTORY, angle_errors)
    content = experiment.file.scenario.model_dump(mode="json")
    if experiment.file.law is not None:
        content["law"]["file"] = LAW
        (folder / LAW).write_bytes(experiment.file.law.source)
    write_json(folder / SCENARIO, content)
    write_json(folder / RESULT, result)
