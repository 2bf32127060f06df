"""The run folder: written whole or not at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from scenarios.errors import InputError

RESULT = "result.json"
TRAJECTORY = "trajectory.npz"
RECORDING = "recording.rrd"
SCENARIO = "scenario.json"
"""The validated scenario, with all changes of the command line: what replay and plots need besides the states."""


def default_path(scenario: str, plant: str, seed: int) -> Path:
    """Where a run goes when no folder is named."""
    return Path("runs") / f"{scenario}-{plant}-seed{seed}"


@contextmanager
def writing(folder: Path) -> Iterator[Path]:
    """A scratch folder beside ``folder`` that takes its place when the block ends well and vanishes when it does not.

    Entering proves that the place can be written, before anything is computed. An older run in the same place is
    replaced; anything else is left alone.

    Raises:
        InputError: the place cannot be written, or holds something that is not a run.
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


def write_text(path: Path, text: str, option: str) -> None:
    """Write a report where the user wants it.

    Raises:
        InputError: it cannot be written there; the message names the command's ``option``.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be written: {error.strerror}") from error


def write_json(path: Path, content: Any) -> None:
    """Write JSON as people read it; numbers keep all their digits."""
    path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
