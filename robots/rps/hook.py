"""Serves modules named ``rps`` to scripts, whether or not an original is installed; nothing of one is used.

    with serving(2):
        runpy.run_path("consensus.py", run_name="__main__")

Every module has the names of both generations; where they mean different things, the one that is served wins.
"""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.machinery
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np

Version = Literal[1, 2]

NAME = "rps"

MODULES: dict[str, dict[Version, str | None]] = {
    "robotarium": {1: "robotarium", 2: "robotarium"},
    "robotarium_abc": {1: "robotarium", 2: "robotarium"},
    "utilities.barrier_certificates": {1: "barrier_certificates", 2: "barrier_certificates"},
    "utilities.barrier_certificates2": {1: "barrier_certificates2", 2: None},
    "utilities.controllers": {1: "controllers", 2: "controllers"},
    "utilities.graph": {1: "graph", 2: "graph"},
    "utilities.misc": {1: "misc", 2: "misc"},
    "utilities.sensors": {1: None, 2: "sensors"},
    "utilities.transformations": {1: "transformations", 2: "transformations"},
    "utilities.uni_ekf": {1: "uni_ekf", 2: None},
    "patch_creation.gternal_patch": {1: None, 2: "gternal_patch"},
}
"""What is served below ``rps``, and the module of each generation that it is made of."""

PACKAGES = ("", "utilities", "patch_creation")

PUBLISHED: dict[Version, str] = {1: "1.0.0", 2: "2.1.0"}
"""The versions that are spoken, as ``rps.__version__`` says."""

ALSO = {
    "utilities.controllers": "utilities.transformations",
    "utilities.barrier_certificates": "utilities.transformations",
}
"""Modules whose ``import *`` brings another one's names too."""

UNDERSCORED = "_solve_qp"
"""What scripts use although its name says that they should not."""


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds and makes the modules.

    Args:
        version: whose meaning wins.
        examples: the folder of ``rps.examples``, where the script has one.
    """

    def __init__(self, version: Version, examples: Path | None = None) -> None:
        self._version: Version = version
        self._examples = examples

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """See :class:`importlib.abc.MetaPathFinder`."""
        head, _, rest = fullname.partition(".")
        if head != NAME:
            return None
        if rest == "examples" or rest.startswith("examples."):
            return self._example(fullname, path)
        if rest in PACKAGES or rest in MODULES or rest == "__version__":
            return importlib.machinery.ModuleSpec(fullname, self, is_package=rest in PACKAGES)
        known = ", ".join(f"{NAME}.{name}" for name in MODULES)
        raise ModuleNotFoundError(f"No module named {fullname!r}; known: {known}", name=fullname)

    def exec_module(self, module: ModuleType) -> None:
        """Fill a module with its names."""
        rest = module.__name__.partition(".")[2]
        if rest in MODULES:
            module.__dict__.update(names(rest, self._version))
        elif rest in ("", "__version__"):
            module.__dict__["__version__"] = PUBLISHED[self._version]

    def _example(self, fullname: str, path: Sequence[str] | None) -> importlib.machinery.ModuleSpec | None:
        if self._examples is None:
            raise ModuleNotFoundError(
                f"No module named {fullname!r}: it is another example's, expected the script in its place beside it",
                name=fullname,
            )
        where = [str(self._examples.parent)] if path is None or not list(path) else list(path)
        return importlib.machinery.PathFinder.find_spec(fullname, where)


def names(rest: str, version: Version) -> dict[str, object]:
    """The names of the module ``rps.<rest>``: of both generations, those of ``version`` where they differ.

    numpy and pyplot are among them where scripts get them from here by ``import *``.
    """
    found: dict[str, object] = {"np": np}
    for generation in sorted(MODULES[rest], key=lambda each: each == version):
        if rest in ALSO:
            found |= made(ALSO[rest], generation)
        found |= made(rest, generation)
    if rest == "utilities.misc" and version == 1:
        found["plt"] = importlib.import_module("matplotlib.pyplot")
    return found


def made(rest: str, generation: Version) -> dict[str, object]:
    """What one generation's module itself has; nothing where it had no such module."""
    if (name := MODULES[rest][generation]) is None:
        return {}
    module = importlib.import_module(f"robots.rps.version{generation}.{name}")
    return {
        name: value
        for name, value in vars(module).items()
        if name == UNDERSCORED
        or (not name.startswith("_") and callable(value) and str(value.__module__).startswith("robots.rps.version"))
    }


@contextmanager
def serving(version: Version, script: Path | None = None) -> Iterator[None]:
    """Serve ``rps`` in this block; what was imported under that name before is put back afterwards."""
    finder = Finder(version, None if script is None else _examples(script))
    before = _imported()
    for name in before:
        del sys.modules[name]
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for name in _imported():
            del sys.modules[name]
        sys.modules.update(before)


def _imported() -> dict[str, ModuleType]:
    return {name: module for name, module in sys.modules.items() if name == NAME or name.startswith(f"{NAME}.")}


def _examples(script: Path) -> Path | None:
    """The folder ``rps/examples`` that a script lies in."""
    folders = script.resolve().parents
    return next((each for each in folders if each.name == "examples" and each.parent.name == NAME), None)
