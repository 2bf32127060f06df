"""Compiled functions, and the folder in which numba keeps their machine code."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile a function on its first call, and keep the machine code for the next process.

    It is kept beside the source, or in the user's cache; where neither can be written, it is compiled by every process.
    """
    try:
        return cast(F, njit(cache=True)(function))
    except RuntimeError:  # numba found no such folder
        return cast(F, njit(function))


def at_hand(function: Callable[..., Any]) -> bool:
    """Whether a compiled function can be called without compiling it: it was called before, maybe elsewhere."""
    dispatcher: Any = function
    if not hasattr(dispatcher, "signatures") or dispatcher.signatures:  # the compiler may be switched off
        return True
    folder, source = dispatcher.stats.cache_path, Path(dispatcher.py_func.__code__.co_filename)
    if folder is None:
        return False
    index = f"{source.stem}.{dispatcher.py_func.__qualname__}-*.py{sys.version_info.major}{sys.version_info.minor}*.nbi"
    return any(file.stat().st_mtime >= source.stat().st_mtime for file in Path(folder).glob(index))
