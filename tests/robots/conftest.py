"""What tests of compiled functions share: the same functions without the compiler."""

from collections.abc import Callable
from types import FunctionType
from typing import Any

import pytest


def uncompiled(function: Any, kept: tuple[str, ...] = (), made: dict[int, Any] | None = None) -> Any:
    """The Python form of a compiled function, and of all compiled functions that it calls, but those that are kept."""
    made = {} if made is None else made
    python = getattr(function, "py_func", None)
    if python is None:  # the compiler is switched off
        return function
    if id(function) not in made:
        seen: dict[str, Any] = {}
        form = FunctionType(python.__code__, seen, python.__name__, python.__defaults__, python.__closure__)
        made[id(function)] = form
        seen.update(python.__globals__)
        for name in python.__code__.co_names:
            if name not in kept and hasattr(seen.get(name), "py_func"):
                seen[name] = uncompiled(seen[name], kept, made)
    return made[id(function)]


@pytest.fixture(scope="session")
def plain() -> Callable[..., Any]:
    """Makes the Python form of a compiled function: no test of a few calls has to wait for the compiler."""
    return uncompiled
