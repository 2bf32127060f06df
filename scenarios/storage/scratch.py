"""Work under way: a hidden folder beside the place that it will take, with a lock that dies with its process.

A process that ends by itself, an interrupt included, takes its scratch with it. What a killed process left is known by
a lock that nobody holds, and the next one that writes into the same parent folder sweeps it up.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from scenarios.errors import InputError
from scenarios.work.signals import Held

if TYPE_CHECKING:
    from filelock import FileLock

SUFFIX = ".unfinished"
LOCK = "formation.lock"

ASIDE = "aside"
"""Folder, inside a scratch, for what stood in the place before: the sweeper puts it back where the place is empty."""

LONGEST_NAME = 100
"""Bytes of a place's name that the name of its scratch repeats; a system allows 255 as a rule."""

PATIENCE = 0.2
"""Seconds to wait for a lock: longer than a sweeper holds it."""


@contextmanager
def beside(place: Path, exclusive: bool, patience: float = PATIENCE) -> Iterator[Path]:
    """A new folder beside ``place`` that is gone when the block ends; the folders above are made.

    Args:
        place: what the work is for.
        exclusive: whether only one process at a time may work for this place.
        patience: seconds to wait for another process.

    Raises:
        InputError: another process works for this place.
        OSError: the folder cannot be written.
    """
    place.parent.mkdir(parents=True, exist_ok=True)
    with _claimed(place, exclusive, patience) as folder:
        sweep(place.parent)
        yield folder


def is_scratch(folder: Path) -> bool:
    """Whether a folder lies in the scratch of a process, that still works or was killed."""
    return any(part.name.endswith(SUFFIX) and (part / LOCK).is_file() for part in folder.resolve().parents)


def sweep(parent: Path) -> None:
    """Remove what killed processes left in a folder; what one of them had moved aside goes back to its place."""
    for folder in parent.glob(f".*{SUFFIX}"):
        if folder.is_symlink() or not folder.is_dir():
            continue
        with suppress(OSError):  # of another user, or swept up by another process: not in our way
            if not (folder / LOCK).exists():
                folder.rmdir()  # killed before it had its lock; a folder that is not empty is not ours
            elif (lock := _lock(folder, 0.0)) is not None:
                _put_back(folder)
                _remove(folder, lock)


@contextmanager
def _claimed(place: Path, exclusive: bool, patience: float) -> Iterator[Path]:
    folder, lock = None, None
    try:
        with Held():
            folder, lock = _make(place, exclusive, patience)
        yield folder
    finally:
        if folder is not None and lock is not None:
            with Held():
                _put_back(folder)
                _remove(folder, lock)


def _make(place: Path, exclusive: bool, patience: float) -> tuple[Path, FileLock]:
    """A scratch folder that nobody else has, and its lock, held.

    Raises:
        InputError: another process works for this place.
        OSError: the folder cannot be written.
    """
    stem = place.name if len(os.fsencode(place.name)) <= LONGEST_NAME else _digest(place.name)
    while True:
        if exclusive:
            folder = place.with_name(f".{stem}{SUFFIX}")
            folder.mkdir(exist_ok=True)
        else:
            folder = Path(tempfile.mkdtemp(prefix=f".{stem}.", suffix=SUFFIX, dir=place.parent))
        try:
            lock = _lock(folder, patience)
        except FileNotFoundError:
            continue  # swept up before it was locked
        if lock is None:
            if exclusive:
                raise InputError(f"{place}: another process is writing it, wait until it is done or name another place")
            continue
        if exclusive:
            _put_back(folder)
            _empty(folder)  # a killed process may have left it
        return folder, lock


def _lock(folder: Path, patience: float) -> FileLock | None:
    """The lock of a scratch folder, held; None where another process holds it.

    Raises:
        OSError: there is no such folder any more, or it cannot be written.
    """
    from filelock import FileLock, Timeout  # takes as long to load as the rest of a command line

    lock = FileLock(folder / LOCK)
    os.stat(folder)
    try:
        lock.acquire(timeout=patience, poll_interval=0.02)
    except Timeout:
        return None
    if not (folder / LOCK).exists():
        lock.release()
        raise FileNotFoundError(folder)
    return lock


def _put_back(folder: Path) -> None:
    """Give what was moved aside its place again, where nothing has taken it."""
    aside = folder / ASIDE
    if aside.is_dir():
        for entry in aside.iterdir():
            if not os.path.lexists(place := folder.parent / entry.name):
                os.replace(entry, place)


def _empty(folder: Path) -> None:
    for entry in folder.iterdir():
        if entry.name != LOCK:
            shutil.rmtree(entry) if entry.is_dir() and not entry.is_symlink() else entry.unlink()


def _remove(folder: Path, lock: FileLock) -> None:
    """Remove a folder whose lock is held; the lock last, so that it never looks like nobody's."""
    try:
        with suppress(OSError):
            _empty(folder)
            (folder / LOCK).unlink()
            folder.rmdir()
    finally:
        lock.release()


def _digest(name: str) -> str:
    return hashlib.sha256(os.fsencode(name)).hexdigest()[:16]
