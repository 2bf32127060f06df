"""Files that are whole or absent, never half-written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from scenarios.errors import InputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A scratch file beside ``path``, of the same kind, that takes its place when the block ends well.

    The folders above are made. Whatever ends the block otherwise, the scratch file is removed and an older file in the
    same place is untouched.

    Raises:
        InputError: the file cannot be written, with the system's reason.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent)
        os.close(handle)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error
    scratch = Path(name)
    try:
        yield scratch
        scratch.chmod(0o644)
        os.replace(scratch, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        scratch.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path``, whole or not at all.

    Raises:
        InputError: the file cannot be written, with the system's reason.
    """
    with replacing(path) as scratch:
        scratch.write_bytes(content)


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
