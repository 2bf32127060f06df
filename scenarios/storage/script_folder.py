"""The folder of a script's run: what a scenario's has, with a copy of the script in the place of the scenario."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from robots.rps.simulation import Record
from scenarios.definition.files.reading import read_json
from scenarios.errors import InputError
from scenarios.simulation.script.frames import Frames
from scenarios.storage.files import write_json
from scenarios.storage.run_folder import RESULT, TRAJECTORY

KIND = "script"
"""What ``kind`` in ``result.json`` says; a scenario's run has no such key."""

SCRIPT = "script.py"
"""The script, as it was when the run was made."""

FRAMES = "figure-frames.npz"
"""The script's figure over time."""


@dataclass(frozen=True, eq=False)
class ScriptRun:
    """A finished run of a script, as its folder holds it."""

    folder: Path
    record: Record
    frames: Frames
    result: dict[str, Any]


def default_path(script: str, plant: str, seed: int) -> Path:
    """Where a run goes when no folder is named."""
    return Path("runs") / f"{script}-{plant}-seed{seed}"


def is_script(folder: Path) -> bool:
    """Whether ``folder`` holds the run of a script."""
    if not ((folder / RESULT).is_file() and (folder / TRAJECTORY).is_file()):
        return False
    try:
        result = read_json(folder / RESULT)
    except InputError:
        return False
    return isinstance(result, dict) and result.get("kind") == KIND


def write(folder: Path, source: bytes, record: Record, frames: Frames, result: dict[str, Any]) -> None:
    """Write all files but pictures and the recording."""
    (folder / SCRIPT).write_bytes(source)
    np.savez_compressed(folder / TRAJECTORY, **{each.name: getattr(record, each.name) for each in fields(record)})
    if frames.pictures:
        content = np.frombuffer(b"".join(frames.pictures), dtype=np.uint8)
        sizes = np.array([len(picture) for picture in frames.pictures])
        np.savez(folder / FRAMES, t=frames.t, sizes=sizes, content=content)
    write_json(folder / RESULT, result)


def read(folder: Path) -> ScriptRun:
    """Read the run of a script back.

    Raises:
        InputError: a file is missing or damaged.
    """
    path = folder / TRAJECTORY
    try:
        with path.open("rb") as file, np.load(file) as data:
            record = Record(*(data[each.name] for each in fields(Record)))
        result = read_json(folder / RESULT)
        shapes = {each.name: getattr(record, each.name).shape[:1] for each in fields(record)}
    except Exception as error:  # numpy, zipfile and json raise many kinds for damaged files
        raise InputError(f"{path}: cannot be read: {error}") from error
    if len(set(shapes.values())) != 1 or record.poses.ndim != 3 or not len(record.t):
        raise InputError(f"{path}: expected one row a step in every array, got {shapes}")
    return ScriptRun(folder, record, _frames(folder / FRAMES), result)


def _frames(path: Path) -> Frames:
    if not path.exists():
        return Frames(np.empty(0), ())
    try:
        with path.open("rb") as file, np.load(file) as data:
            t, ends, content = data["t"], np.cumsum(data["sizes"]), data["content"].tobytes()
    except Exception as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    begins = np.concatenate([[0], ends[:-1]])
    return Frames(t, tuple(content[a:b] for a, b in zip(begins.tolist(), ends.tolist(), strict=True)))
