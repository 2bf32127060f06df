"""Machine code in files: where it is kept, whole or not at all, and how it is loaded, which takes llvmlite alone."""

from __future__ import annotations

import ctypes
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from itertools import count
from pathlib import Path
from typing import Any, cast

import numpy as np

DIGEST = 32
"""Bytes of the SHA-256 digest before the content of a file."""

RELEASE = "NRT_MemInfo_call_dtor"
"""What numba's arrays would call to free memory that it manages: none does, all of it comes from Python."""


_number = count()

_NATIVE = ctypes.CFUNCTYPE(ctypes.c_int, *[ctypes.c_void_p] * 4)
"""How numba calls functions of two addresses: room for what they return and for an error, then these; a status back."""


def folder(source: str, parts: Iterable[str], given: str) -> Path:
    """Where to keep a function of a ``source`` file that is made of parts, in a ``given`` folder or beside the source.

    numba itself looks at the time of one file alone, and cannot read what names a class that has moved.
    """
    digest = hashlib.sha256("\n".join(sorted(parts)).encode()).hexdigest()
    base = Path(given) if given else Path(source).parent / "__pycache__"
    return base / f"compiled-{digest[:12]}"


def folders(source: str, parts: Iterable[str]) -> Iterator[Path]:
    """Where machine code may be: beside the source, or in the user's cache where that cannot be written."""
    given = setting("CACHE_DIR", "")
    yield folder(source, parts, given)
    if not given:
        with suppress(RuntimeError):  # nobody's home is known
            home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
            yield folder(source, parts, str(Path(home) / "angle-formation"))


def setting(name: str, absent: str) -> str:
    """A setting of numba: that of its own, where it is loaded, or of the environment that it would read."""
    loaded: Any = sys.modules.get("numba")
    return str(getattr(loaded.config, name)) if loaded else os.environ.get(f"NUMBA_{name}", absent)


@cache
def machine() -> str:
    """What machine code depends on beside the source: this processor, and who makes the code."""
    import llvmlite.binding as llvm

    made_by = f"numba {version('numba')}, llvmlite {version('llvmlite')}"
    return (
        f"{llvm.get_process_triple()}, {llvm.get_host_cpu_name()}, {llvm.get_host_cpu_features().flatten()}, {made_by}"
    )


def read(places: Iterable[Path], name: str) -> bytes | None:
    """The machine code of that name; None where none is, or none that is whole."""
    for place in places:
        with suppress(OSError):
            content = (place / name).read_bytes()
            if hashlib.sha256(content[DIGEST:]).digest() == content[:DIGEST]:
                return content[DIGEST:]
    return None


def write(places: Iterable[Path], name: str, code: bytes) -> None:
    """Keep machine code in the first place that can be written; in none where none can."""
    for place in places:
        with suppress(OSError):
            place.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=place) as scratch:  # which a full disk leaves nothing of
                new = Path(scratch) / name
                new.write_bytes(hashlib.sha256(code).digest() + code)
                os.replace(new, place / name)
            return


def load(code: bytes, symbol: str) -> Callable[[int, int], None]:
    """A function of two addresses in machine code, ready to be called.

    Raises:
        RuntimeError: the code names something that this process has not.
    """
    import llvmlite.binding as llvm

    builder = llvm.JITLibraryBuilder().add_object_img(code).add_current_process().export_symbol(symbol)
    builder.import_symbol(RELEASE, ctypes.cast(_nothing_to_release, ctypes.c_void_p).value)
    library = builder.link(_compiler(), f"{symbol} {next(_number)}")
    call = _NATIVE(library[symbol])
    answer = np.zeros(2, dtype=np.int64)
    nothing, error = answer.ctypes.data, answer.ctypes.data + answer.itemsize

    def checked(one: int, other: int, library: Any = library, answer: Any = answer) -> None:  # which live as long
        if status := call(nothing, error, one, other):
            raise RuntimeError(f"{symbol}: compiled code ended with status {status}")

    return checked


def emitted(text: str, symbol: str, name: str) -> bytes:
    """The machine code, for this processor, of a function in an optimised module in LLVM's language, by a new name.

    What it does not need stays out, above all calls of Python's own functions.
    """
    import llvmlite.binding as llvm

    _initialised()
    module = llvm.parse_assembly(text)
    for function in module.functions:
        if not function.is_declaration and function.name != symbol:
            function.linkage = "internal"
    module.get_function(symbol).name = name
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    target = _target()
    passes.run(module, llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options()))
    return cast(bytes, target.emit_object(module))


@cache
def _initialised() -> None:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


@cache
def _compiler() -> Any:
    import llvmlite.binding as llvm

    _initialised()
    return llvm.create_lljit_compiler(_target(), suppress_errors=True)


def _target() -> Any:
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3, jit=True)


_nothing_to_release = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(lambda block: None)
