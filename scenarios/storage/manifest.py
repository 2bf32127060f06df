"""Which files of a run folder the project itself wrote, by name and digest: all others belong to the user.

``sha256sum --check manifest.sha256`` reads the same file.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from scenarios.definition.files.reading import read_regular
from scenarios.storage import scratch

NAME = "manifest.sha256"

PATIENCE = 10.0
"""Seconds to wait for another process that writes the manifest."""

Written = frozenset[tuple[str, str]]
"""(name, digest) of each file; a file that was being replaced when its process was killed has two digests."""


def write(folder: Path) -> None:
    """Declare every file of a folder, which nobody else uses yet, as written by the project.

    Raises:
        OSError: the folder cannot be written.
    """
    _save(folder / NAME, [(path.name, _digest(path)) for path in folder.iterdir()])


@contextmanager
def declaring(place: Path, new: Path) -> Iterator[None]:
    """Declare that the project puts the file ``new`` in its ``place``, which the block does; nothing without manifest.

    Whenever the process is killed, what stands in the place is known.

    Raises:
        OSError: the folder cannot be written.
    """
    if _read(place.parent) is None:
        yield
        return
    entry = (place.name, _digest(new))
    _edit(place.parent, lambda known: known | {entry})
    yield
    _edit(place.parent, lambda known: {e for e in known if e[0] != place.name} | {entry})


def foreign(folder: Path) -> str | None:
    """What in a folder is not as the project wrote it, in words for a message; None where all of it is.

    An empty folder has nothing that could be lost.
    """
    entries = sorted(folder.iterdir())
    if not entries:
        return None
    known = _read(folder)
    if known is None:
        return f"exists and is not a run folder: it holds {entries[0].name} and no {NAME}"
    names = {name for name, _ in known}
    for path in entries:
        if path.name == NAME:
            continue
        if path.name.endswith(scratch.SUFFIX):
            return "is being written by another process"
        if path.name not in names:
            return f"holds {path.name}, which no run wrote"
        if path.is_symlink() or not path.is_file() or (path.name, _digest(path)) not in known:
            return f"holds {path.name}, which was changed since it was written"
    return None


def changed(path: Path) -> bool:
    """Whether a file is another than the one that its folder's manifest declares; False where it declares none."""
    known = _read(path.parent) or frozenset()
    declared = {digest for name, digest in known if name == path.name}
    return bool(declared) and _digest(path) not in declared


def _read(folder: Path) -> Written | None:
    """What is declared; None where there is no manifest that can be read."""
    try:
        lines = read_regular(folder / NAME).decode().splitlines()
    except (OSError, ValueError):
        return None
    found = [re.fullmatch(r"([0-9a-f]{64})  (.+)", line) for line in lines]
    return frozenset((match[2], match[1]) for match in found if match)


def _edit(folder: Path, change: Callable[[Written], Iterable[tuple[str, str]]]) -> None:
    with scratch.beside(folder / NAME, exclusive=True, patience=PATIENCE) as room:
        _save(room / NAME, change(_read(folder) or frozenset()))
        os.replace(room / NAME, folder / NAME)


def _save(path: Path, written: Iterable[tuple[str, str]]) -> None:
    path.write_text("".join(f"{digest}  {name}\n" for name, digest in sorted(written)), encoding="utf-8")


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
