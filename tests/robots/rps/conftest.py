"""What tests of the public simulator's interface share: draws as there, and the original where it is installed."""

import importlib
import os
import random
import sys
import warnings
from collections.abc import Callable, Iterator
from types import ModuleType

import numpy as np
import pytest

ORIGINALS = {1: "RPS1", 2: "RPS2", 2018: "RPS2018"}
"""Environment variables that name folders with the public simulator of a generation, or a year, unchanged."""


@pytest.fixture
def global_draws() -> Iterator[Callable[[int], None]]:
    """Seeds the generators that scripts draw from; put back afterwards."""
    numpy_before, python_before = np.random.get_state(), random.getstate()  # noqa: NPY002

    def seed(value: int) -> None:
        np.random.seed(value)  # noqa: NPY002
        random.seed(value)

    seed(0)
    yield seed
    np.random.set_state(numpy_before)  # noqa: NPY002
    random.setstate(python_before)


@pytest.fixture
def original() -> Iterator[Callable[[int, str], ModuleType]]:
    """Imports a module of the original; the test is skipped where it is not installed."""
    path = list(sys.path)

    def load(version: int, module: str) -> ModuleType:
        folder = os.environ.get(ORIGINALS[version])
        if folder is None:
            pytest.skip(f"{ORIGINALS[version]} names no folder of the public simulator")
        sys.path[:] = [folder, *path]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return importlib.import_module(f"rps.{module}")

    yield load
    sys.path[:] = path
    for name in [name for name in sys.modules if name.split(".")[0] == "rps"]:
        del sys.modules[name]
