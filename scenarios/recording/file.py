"""A recording as a file: whole or not there, with a digest beside it that tells of every damage.

``rerun rrd verify`` lets about half of all flipped bytes pass; the digest lets none.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path


def write(path: Path, content: bytes) -> None:
    """Put a recording and its digest in their places, whole or not at all.

    Raises:
        OSError: the disk is full or the folder cannot be written.
    """
    _replace(path, content)
    _replace(_digest_of(path), f"{hashlib.sha256(content).hexdigest()}  {path.name}\n".encode())


def damage(path: Path) -> str | None:
    """What is wrong with a recording, in one word; None for a whole one."""
    if not path.is_file():
        return "missing"
    try:
        digest = _digest_of(path).read_text(encoding="ascii").split()[0]
        return None if digest == hashlib.sha256(path.read_bytes()).hexdigest() else "damaged"
    except (OSError, ValueError, IndexError):
        return "damaged"


def _digest_of(path: Path) -> Path:
    """The file that ``sha256sum --check`` takes."""
    return path.with_suffix(".sha256")


def _replace(path: Path, content: bytes) -> None:
    scratch = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        scratch.write_bytes(content)
        os.replace(scratch, path)
    finally:
        scratch.unlink(missing_ok=True)
