"""Functions that numba compiles when they are first called, by Python or by one another."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar, cast

from robots.compiled import kept

F = TypeVar("F", bound=Callable[..., Any])

CONSTANTS = (int, float, tuple)


class Deferred:
    """Something for compiled functions that only numba can make.

    Attributes:
        for_compiled: it, made when the first function that names it is compiled.
    """

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    @cached_property
    def for_compiled(self) -> Any:
        return self._make()

    def __call__(self, *arguments: Any) -> Any:
        """For the eyes of readers and type checkers: compiled functions call what is made."""
        return self.for_compiled(*arguments)


class Compiled(Deferred):
    """A function and what numba makes of it.

    Attributes:
        py_func: the function as it is written.
    """

    def __init__(self, function: Callable[..., Any], **options: bool) -> None:
        super().__init__(lambda: self._made(no_cpython_wrapper=True, no_cfunc_wrapper=True, **options))
        self.py_func = function
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self.for_python(*arguments)

    @cached_property
    def for_python(self) -> Any:
        """What Python calls; its machine code is kept for the next process, where there is a folder for it."""
        from numba import config

        settings: Any = config
        given = settings.CACHE_DIR
        settings.CACHE_DIR = str(kept.folder(self.py_func.__code__.co_filename, ingredients(self), given))
        try:
            return self._made(cache=True)
        except RuntimeError:  # numba found no such folder
            return self._made()
        finally:
            settings.CACHE_DIR = given

    def _made(self, **options: Any) -> Any:
        """The function with what numba makes of the compiled ones that it calls, compiled.

        Arithmetic is that of numpy: a division by zero gives an infinity or NaN and raises nothing, and no operation is
        contracted or reordered, so that one run gives the same bits alone and among others.
        """
        from numba import njit

        function = self.py_func
        seen = {name: value.for_compiled for name, value in _seen(function).items() if isinstance(value, Deferred)}
        made = FunctionType(function.__code__, function.__globals__ | seen, function.__name__, function.__defaults__)
        return njit(error_model="numpy", **options)(made)


def compiled(function: F) -> F:
    """Compile a function when it is first called."""
    return cast(F, Compiled(function))


def inlined(function: F) -> F:
    """Compile a function into its callers, so that their loops over runs become vector instructions.

    LLVM does that; where numba does it (``inline="always"``), compiling takes longer and the code is no faster.
    """
    return cast(F, Compiled(function, forceinline=True))


def intrinsic(typing: Callable[..., Any]) -> Deferred:
    """Something that compiled functions call, whose instructions ``typing`` gives as numba's ``intrinsic`` has it."""

    def make() -> Any:
        from numba.extending import intrinsic

        return intrinsic(typing)

    return Deferred(make)


def ingredients(function: Callable[..., Any]) -> frozenset[str]:
    """What the machine code of a function may depend on, as text.

    The content of its file and of those of all compiled functions that it calls, and the constants that they name,
    which may stand in yet other files.
    """
    written = function.py_func if isinstance(function, Compiled) else function
    parts = {_content(written.__code__.co_filename)}
    for name, value in _seen(written).items():
        if isinstance(value, CONSTANTS):
            parts.add(f"{name} = {value!r}")
        elif isinstance(value, Compiled):
            parts |= ingredients(value)
    return frozenset(parts)


def _seen(function: Callable[..., Any]) -> dict[str, Any]:
    """The globals that a function names."""
    names, there = function.__code__.co_names, function.__globals__
    return {name: there[name] for name in names if name in there}


@cache
def _content(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()
