"""Files that are whole or absent, never half-written: every file that a command replaces is replaced here."""

from __future__ import annotations

import json
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from scenarios.errors import InputError
from scenarios.storage import manifest, scratch


@contextmanager
def replacing(path: Path, option: str = "") -> Iterator[Path]:
    """A name for a scratch file, of the same kind, that takes the place of ``path`` when the block ends well.

    The folders above are made. Whatever ends the block otherwise, the scratch file is removed and an older file in the
    same place is untouched; the new one has its permissions. A link stays a link. In a run folder, the file counts as
    written by the project from then on.

    Raises:
        InputError: the file cannot be written, with the system's reason; the message begins with the command's
            ``option`` where one is given.
    """
    try:
        with _replacing(path) as new:
            yield new
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be written: {error.strerror or error}".strip()) from error


def put(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path``, whole or not at all.

    Raises:
        OSError: the file cannot be written.
    """
    with _replacing(path) as new:
        new.write_bytes(content)


@contextmanager
def _replacing(path: Path) -> Iterator[Path]:
    place = Path(os.path.realpath(path))
    with scratch.beside(place, exclusive=False) as room:
        new = room / place.name
        yield new
        if place.is_file():
            shutil.copymode(place, new)
        with manifest.declaring(place, new):
            os.replace(new, place)


def write_whole(path: Path, content: bytes, option: str = "") -> None:
    """Write ``content`` to ``path``, whole or not at all; into a device or a pipe as it is.

    Raises:
        InputError: the file cannot be written, with the system's reason.
    """
    if _is_stream(path):
        try:
            path.write_bytes(content)
        except OSError as error:
            raise InputError(f"{option} {path}: cannot be written: {error.strerror}".strip()) from error
        return
    with replacing(path, option) as new:
        new.write_bytes(content)


def write_text(path: Path, text: str, option: str) -> None:
    """Write a report where the user wants it, whole or not at all.

    Raises:
        InputError: it cannot be written there; the message names the command's ``option``.
    """
    write_whole(path, text.encode(), option)


def prove_writable(path: Path, option: str) -> None:
    """Find out, before anything is computed, whether a file can be written; it is left as it is.

    Raises:
        InputError: it cannot.
    """
    try:
        if _is_stream(path):
            return
        if path.is_dir():
            raise IsADirectoryError(21, "Is a directory")
        with scratch.beside(Path(os.path.realpath(path)), exclusive=False):
            pass
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be written: {error.strerror}") from error


def _is_stream(path: Path) -> bool:
    """Whether there is something that takes what is written and keeps nothing: /dev/stdout, a pipe."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def write_json(path: Path, content: Any) -> None:
    """Write JSON as people read it; numbers keep all their digits."""
    path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
