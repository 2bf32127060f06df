"""Compiled functions, and the folder in which numba keeps their machine code."""

from __future__ import annotations

from collections.abc import Callable
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
    # numba tells only after a call whether it found machine code of this source; the index that it would read says so.
    index = getattr(dispatcher._cache, "_cache_file", None)
    return index is not None and bool(index._load_index())
