"""A recording as a file: whole or not there, with a digest beside it that tells of every damage.

``rerun rrd verify`` lets about half of all flipped bytes pass; the digest lets none.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from scenarios.definition.files.reading import open_regular, read_regular
from scenarios.storage.files import put


def write(path: Path, content: bytes) -> None:
    """Put a recording and its digest in their places, whole or not at all.

    Raises:
        OSError: the disk is full or the folder cannot be written.
    """
    put(path, content)
    put(_digest_of(path), f"{hashlib.sha256(content).hexdigest()}  {path.name}\n".encode())


def damage(path: Path) -> str | None:
    """What is wrong with a recording, in one word; None for a whole one."""
    if not os.path.isfile(path):
        return "missing"
    try:
        digest = read_regular(_digest_of(path)).decode("ascii").split()[0]
        with open_regular(path) as content:
            return None if digest == hashlib.file_digest(content, "sha256").hexdigest() else "damaged"
    except (OSError, ValueError, IndexError):
        return "damaged"


def _digest_of(path: Path) -> Path:
    """The file that ``sha256sum --check`` takes."""
    return path.with_suffix(".sha256")
