"""A script written for the Robotarium: its file, and the generation of ``rps`` that it speaks to."""

from __future__ import annotations

import ast
import hashlib
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from robots.rps.hook import MODULES, Version, made
from scenarios.definition.files.reading import read_regular
from scenarios.errors import InputError

COMMON = frozenset({"axes", "figure", "poses", "velocities", "obstacles", "initial_conditions", "robot", "look"})
"""Attributes of one generation's class that other things have too: they tell nothing."""

ENDS: dict[Version, str] = {1: "call_at_scripts_end", 2: "debug"}
"""The call that ends a script; ours answer to both."""


@dataclass(frozen=True, eq=False)
class ScriptFile:
    """A script to run.

    Attributes:
        path: where it is.
        source: what it holds.
        version: the generation of ``rps`` that it speaks to.
        marks: the names by which that was told; none where it was asked for.
    """

    path: Path
    source: bytes
    version: Version
    marks: tuple[str, ...]

    @property
    def name(self) -> str:
        """How people call it."""
        return self.path.stem

    @property
    def sha256(self) -> str:
        """Of its content."""
        return hashlib.sha256(self.source).hexdigest()


def read(path: Path, version: Version | None = None) -> ScriptFile:
    """Read a script; ``version`` in the place of what its names say.

    Raises:
        InputError: there is no such file, or it is not Python.
    """
    if path.suffix == ".m":
        raise InputError(f"{path}: a MATLAB script; expected a Python script for rps")
    if path.is_dir():
        raise InputError(f"{path}: a folder; expected a script in it, such as {path / '__main__.py'}")
    try:
        source = read_regular(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    try:
        used = _used(source, path)
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None)
        old = "; Python 2?" if b"print " in source else ""
        raise InputError(f"{path}{f':{line}' if line else ''}: not Python {_python()}: {error.args[0]}{old}") from error
    found: dict[Version, list[str]] = {each: sorted(used & marks(each)) for each in (1, 2)}
    told: Version = 1 if len(found[1]) > len(found[2]) else 2
    if version is not None:
        return ScriptFile(path, source, version, ())
    return ScriptFile(path, source, told, tuple(found[told]))


@cache
def marks(version: Version) -> frozenset[str]:
    """Names that only this generation of ``rps`` has."""
    other: Version = 2 if version == 1 else 1
    return _names(version) - _names(other) - COMMON | {ENDS[version]}


def _names(version: Version) -> frozenset[str]:
    from robots.rps.version1.robotarium import Robotarium as First
    from robots.rps.version2.robotarium import Robotarium as Second

    of_class = {name for name in vars(First if version == 1 else Second) if not name.startswith("__")}
    served = {name for rest in MODULES for name in made(rest, version)}
    return frozenset(of_class | served) - {ENDS[1], ENDS[2]}


def _used(source: bytes, path: Path, seen: frozenset[Path] = frozenset()) -> set[str]:
    """All names and attributes in a script and in the modules beside it that it imports."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of strings that Python may refuse one day
        tree = ast.parse(source, str(path))
    used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    used |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    used |= {node.arg for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg is not None}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            used |= {alias.name for alias in node.names}
    for module in _imports(tree):
        file = path.parent.joinpath(*module.split(".")).with_suffix(".py")
        if file.is_file() and file not in seen:
            try:
                used |= _used(file.read_bytes(), file, seen | {file})
            except (OSError, SyntaxError, ValueError):
                continue  # Python will say so, if the script comes to it
    return used


def _imports(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def _python() -> str:
    import sys

    return f"{sys.version_info.major}.{sys.version_info.minor}"
