"""Files that a person names, read only where they are what they should be: regular, and of a sane size.

Without this a device never ends, a pipe waits for a writer that never comes, and a slip of the keys fills the memory.
"""

from __future__ import annotations

import errno
import json
import os
import stat
from io import BufferedReader
from pathlib import Path
from typing import Any

from scenarios.errors import InputError

LARGEST = 64 * 2**20
"""Bytes of a text that is read as a whole: a scenario, a law, a result, a baseline."""

PIECE = 2**16
"""Bytes read at once."""


def read_regular(path: Path, largest: int = LARGEST) -> bytes:
    """The content of a regular file.

    Raises:
        OSError: there is none, it cannot be read, is not a regular file, or is larger than ``largest`` bytes.
        ValueError: the path has a null byte.
    """
    pieces, size = [], 0
    with open_regular(path) as file:
        while piece := file.read(PIECE):  # the size of a file may be a lie, as in /proc
            size += len(piece)
            if size > largest:
                raise OSError(errno.EFBIG, f"larger than {largest} bytes", str(path))
            pieces.append(piece)
    return b"".join(pieces)


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file of any size to read.

    Raises:
        OSError: there is none, or it cannot be read.
        ValueError: the path has a null byte.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # a pipe without a writer would wait for one
    if not stat.S_ISREG(mode := os.fstat(descriptor).st_mode):
        os.close(descriptor)
        code = errno.EISDIR if stat.S_ISDIR(mode) else errno.EINVAL
        raise OSError(code, os.strerror(code) if code == errno.EISDIR else "not a regular file", str(path))
    return os.fdopen(descriptor, "rb")


def read_json(path: Path) -> Any:
    """The content of a JSON file.

    Raises:
        InputError: it cannot be read, or is not JSON.
    """
    try:
        return json.loads(read_regular(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:  # besides what is not JSON: numbers too long, nesting too deep
        raise InputError(f"{path}: not valid JSON: {error}") from error
