"""The run folder: written whole or not at all, and read back."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenarios.errors import InputError

if TYPE_CHECKING:
    from scenarios.definition.experiment import Experiment
    from scenarios.definition.load import ScenarioFile
    from scenarios.simulation.trajectory import Trajectory

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
    replaced; anything else is left alone.

    Raises:
        InputError: the place cannot be written, now or later (a full disk), or holds something that is not a run.
    """
    try:
        place = Path(os.path.realpath(folder))  # what a link points to is replaced, not the link
        if place.exists() and not is_run(place) and (not place.is_dir() or any(place.iterdir())):
            raise InputError(f"--out {folder}: exists and is not a run folder")
        place.parent.mkdir(parents=True, exist_ok=True)
        parent = Path(tempfile.mkdtemp(prefix=f".{place.name[:100]}.", dir=place.parent))
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from error
    scratch, older = parent / "new", parent / "old"
    try:
        scratch.mkdir()
        yield scratch
        if place.exists():
            os.replace(place, older)  # whole, so that no half-deleted folder ever stands in its place
        os.replace(scratch, place)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from error
    finally:
        if older.exists() and not place.exists():
            os.replace(older, place)
        shutil.rmtree(parent, ignore_errors=True)


def is_run(folder: Path) -> bool:
    """Whether ``folder`` holds a run."""
    return (folder / RESULT).is_file() and (folder / TRAJECTORY).is_file()


def read(folder: Path) -> Run:
    """Read a run folder back.

    Raises:
        InputError: it is not a run folder, or one of its files is missing, damaged or of another run.
    """
    # The command line imports this module before it knows its command; only reading needs the whole experiment.
    from scenarios.definition import law_file
    from scenarios.definition.experiment import build
    from scenarios.definition.load import ScenarioFile, validate
    from scenarios.simulation.trajectory import Trajectory

    if not folder.exists():
        raise InputError(f"{folder}: no such run folder")
    if not is_run(folder):
        raise InputError(f"{folder}: not a run folder, it holds no {RESULT} and {TRAJECTORY}")
    result, scenario_path = _read_json(folder / RESULT), folder / SCENARIO
    for key, kind in (("scenario", str), ("seed", int), ("planned_duration_s", float)):
        if not isinstance(result.get(key), kind):
            raise InputError(f"{folder / RESULT}: {key}: expected {kind.__name__}, got {result.get(key)!r}")
    scenario = validate(_read_json(scenario_path), str(scenario_path))
    law = None if scenario.law.file is None else law_file.read(str(scenario_path), folder, scenario.law.file)
    file = ScenarioFile(result["scenario"], str(scenario_path), "", scenario, law)
    experiment = build(file, result["planned_duration_s"], to_run=False)
    trajectory = Trajectory.read(folder / TRAJECTORY)
    rows, n = trajectory.t.size, experiment.n
    expected = {
        "t": (max(rows, 1),),
        "poses": (rows, n, 3),
        "points": (rows, n, 2),
        "wheel_speeds": (rows, n, 2),
        "phase": (rows,),
        "active": (rows, n),
    }
    for key, shape in expected.items():
        found = getattr(trajectory, key).shape
        if found != shape:
            raise InputError(f"{folder / TRAJECTORY}: {key}: expected the shape {shape}, got {found}")
    return Run(folder, experiment, trajectory, result)


def write_scenario(folder: Path, file: ScenarioFile) -> None:
    """Write what a run was made from, so that the folder needs nothing outside it."""
    content = file.scenario.model_dump(mode="json")
    if file.law is not None:
        content["law"]["file"] = LAW
        (folder / LAW).write_bytes(file.law.source)
    write_json(folder / SCENARIO, content)


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: expected a JSON object, got {type(content).__name__}")
    return content


def write_json(path: Path, content: Any) -> None:
    """Write JSON as people read it; numbers keep all their digits."""
    path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
