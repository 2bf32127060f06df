"""Compiled functions, and the folder in which numba keeps their machine code."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import config as numba_config
from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_DISPATCHER = type(njit(lambda: None))

_made_of: dict[Any, frozenset[str]] = {}  # compiled functions: what their machine code depends on


def compiled(function: F) -> F:
    """Compile a function on its first call, and keep the machine code for the next process.

    It is kept beside the source, or in the user's cache; where neither can be written, it is compiled by every process.
    Arithmetic is that of numpy: a division by zero gives an infinity or NaN and raises nothing, and no operation is
    contracted or reordered, so that one run gives the same bits alone and among others.
    """
    config: Any = numba_config
    given = config.CACHE_DIR
    parts = ingredients(function)
    config.CACHE_DIR = _folder(function, parts, given)
    try:
        made = njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba found no such folder
        made = njit(error_model="numpy")(function)
    finally:
        config.CACHE_DIR = given
    _made_of[made] = parts
    return cast(F, made)


def inlined(function: F) -> F:
    """Compile a function into its callers, so that their loops over runs become vector instructions."""
    made = njit(inline="always", error_model="numpy")(function)
    _made_of[made] = ingredients(function)
    return cast(F, made)


def at_hand(function: Callable[..., Any]) -> bool:
    """Whether a compiled function can be called without compiling it: it was called before, maybe elsewhere."""
    dispatcher: Any = function
    if not hasattr(dispatcher, "signatures") or dispatcher.signatures:  # the compiler may be switched off
        return True
    # numba tells only after a call whether it found machine code of this source; the index that it would read says so.
    index = getattr(dispatcher._cache, "_cache_file", None)
    return index is not None and bool(index._load_index())


def ingredients(function: Callable[..., Any]) -> frozenset[str]:
    """What the machine code of a function may depend on, as text.

    The content of its own file and those of all compiled functions that it can see, and the constants that it names,
    which may stand in yet another file.
    """
    seen: Mapping[str, Any] = function.__globals__
    parts = {_content(function.__code__.co_filename)}
    for name in function.__code__.co_names:
        if isinstance(value := seen.get(name), (int, float, tuple)):
            parts.add(f"{name} = {value!r}")
    for thing in seen.values():
        if isinstance(thing, _DISPATCHER) and thing in _made_of:
            parts |= _made_of[thing]
    return frozenset(parts)


@cache
def _content(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def _folder(function: Callable[..., Any], parts: frozenset[str], given: str) -> str:
    """Where to keep a function made of parts, so that what another version left there is not even opened.

    numba itself looks at the time of one file alone, and cannot read what names a class that has moved.
    """
    digest = hashlib.sha256("\n".join(sorted(parts)).encode())
    base = Path(given) if given else Path(function.__code__.co_filename).parent / "__pycache__"
    return str(base / f"compiled-{digest.hexdigest()[:12]}")
