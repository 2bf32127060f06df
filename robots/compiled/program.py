"""Functions that Python calls in every run, by the address of their machine code: numba is loaded to make that only.

A program takes arrays that lie in one piece, numbers, and named tuples of these, and returns nothing: what it has to
say it writes into arrays. They are handed over as two rows of numbers: integers, among them the addresses and shapes of
arrays, and floats. What stands where is the program's layout, which arguments of the same types share.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from robots.compiled import kept
from robots.compiled.functions import Compiled, ingredients
from robots.compiled.memory import ARRAY, AT

F = TypeVar("F", bound=Callable[..., Any])

ENTRY = "entry"
"""Name of what is generated, and called."""

WRAPPED = "cfunc."
"""How numba names what C can call: this before the name of the function itself."""


class Program(Compiled):
    """A compiled function whose machine code outlives numba."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._entries: dict[str, Callable[[int, int], None]] = {}
        self._packed: dict[int, tuple[Any, _Packed]] = {}

    def __call__(self, *arguments: Any) -> None:
        if switched_off():
            self.py_func(*arguments)
            return
        parts = [self._pack(place, argument) for place, argument in enumerate(arguments)]
        layout = ",".join([part.layout for part in parts])
        entry = self._entries.get(layout)
        if entry is None:
            entry = self._entries[layout] = self._entry(arguments, layout)
        words = np.array([word for part in parts for word in part.words], dtype=np.int64)
        numbers = np.array([number for part in parts for number in part.numbers], dtype=np.float64)
        entry(words.ctypes.data, numbers.ctypes.data)

    def at_hand(self) -> bool:
        """Whether there is machine code of it, for whatever arguments."""
        return bool(self._entries) or any(next(place.glob(self._names("*")), None) for place in self._places)

    def _pack(self, place: int, argument: Any) -> _Packed:
        """An argument as numbers; named tuples, which do not change, are taken apart once."""
        if not isinstance(argument, tuple):
            return _Packed.of(argument)
        known = self._packed.get(place)
        if known is None or known[0] is not argument:
            known = self._packed[place] = argument, _Packed.of(argument)
        return known[1]

    @cached_property
    def _places(self) -> list[Path]:
        return list(kept.folders(self.py_func.__code__.co_filename, ingredients(self)))

    def _names(self, layout: str) -> str:
        """Names of files, for a layout or all."""
        return f"{self.py_func.__name__}-{hashlib.sha256(kept.machine().encode()).hexdigest()[:8]}-{layout}.o"

    def _entry(self, arguments: tuple[Any, ...], layout: str) -> Callable[[int, int], None]:
        name = self._names(hashlib.sha256(layout.encode()).hexdigest()[:8])
        if (code := kept.read(self._places, name)) is not None:
            with suppress(RuntimeError):  # made for a machine that had something else: made anew
                return kept.load(code, ENTRY)
        code = self._compile(arguments)
        kept.write(self._places, name, code)
        return kept.load(code, ENTRY)

    def _compile(self, arguments: tuple[Any, ...]) -> bytes:
        from numba import cfunc, types

        source = _Source(self)
        call = ", ".join([source.argument(argument) for argument in arguments])
        lines = [
            f"def {ENTRY}(words, numbers):",
            f"    w, x = array(words, {source.words}), array(numbers, {source.numbers})",
            f"    function({call})",
        ]
        exec("\n".join(lines), source.names)
        rows: Any = types.CPointer(types.int64), types.CPointer(types.float64)  # type: ignore[no-untyped-call]
        made = cfunc(types.void(*rows), error_model="numpy")(source.names[ENTRY])
        return kept.emitted(made.inspect_llvm(), made.native_name.removeprefix(WRAPPED), ENTRY)


def program(function: F) -> F:
    """Make a program of a function; other compiled functions can call it too."""
    return cast(F, Program(function))


class _Packed:
    """An argument as integers and floats, and what they are."""

    def __init__(self) -> None:
        self.words: list[int] = []
        self.numbers: list[float] = []
        self.layout = ""

    @classmethod
    def of(cls, argument: Any) -> _Packed:
        packed = cls()
        packed.layout = packed._add(argument)
        return packed

    def _add(self, value: Any) -> str:
        if isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise ValueError(f"an array of shape {value.shape} does not lie in one piece")
            self.words += [value.ctypes.data, *value.shape]
            return f"{value.dtype.str}{value.ndim}"
        if isinstance(value, tuple):
            return f"{type(value).__qualname__}({','.join([self._add(part) for part in value])})"
        if isinstance(value, float):
            self.numbers.append(value)
            return "x"
        self.words.append(int(value))
        return "b" if isinstance(value, bool) else "w"


class _Source:
    """The words of a function that calls another one with what two rows of numbers hold.

    Attributes:
        names: what the words mean.
        words, numbers: how many there are in either row.
    """

    def __init__(self, function: Compiled) -> None:
        self.names: dict[str, Any] = {"function": function.for_compiled}
        self.names |= {"array": ARRAY.for_compiled, "at": AT.for_compiled}
        self.words = self.numbers = 0

    def argument(self, value: Any) -> str:
        if isinstance(value, np.ndarray):
            address = self._word()
            shape = "".join([f"{self._word()}, " for _ in value.shape])
            return f"array(at({address}), ({shape}), {self._named(value.dtype.type)})"
        if isinstance(value, tuple):
            parts = ", ".join([self.argument(part) for part in value])
            return f"{self._named(type(value))}({parts})"
        if isinstance(value, float):
            self.numbers += 1
            return f"x[{self.numbers - 1}]"
        word = self._word()
        return f"({word} != 0)" if isinstance(value, bool) else word

    def _word(self) -> str:
        self.words += 1
        return f"w[{self.words - 1}]"

    def _named(self, thing: type) -> str:
        self.names[f"t_{thing.__name__}"] = thing
        return f"t_{thing.__name__}"


def switched_off() -> bool:
    """Whether the user wants Python in the place of all compiled code, by ``NUMBA_DISABLE_JIT=1``."""
    return kept.setting("DISABLE_JIT", "0") not in ("", "0", "False")


def at_hand(function: Callable[..., Any]) -> bool:
    """Whether a compiled function can be called without compiling it: it was called before, maybe elsewhere."""
    if switched_off() or not isinstance(function, Compiled):
        return True
    if isinstance(function, Program):
        return function.at_hand()
    dispatcher = function.for_python
    if dispatcher.signatures:
        return True
    # numba tells only after a call whether it found machine code of this source; the index that it would read says so.
    index = getattr(dispatcher._cache, "_cache_file", None)
    return index is not None and bool(index._load_index())
