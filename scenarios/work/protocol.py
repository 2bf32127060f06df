"""What spreads work, whatever does it; and what a worker elsewhere must have to do the work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, Protocol, TypeVar

AHEAD = 32
"""Tasks per worker that are taken before their turn: memory does not grow with the number of tasks."""

Task = TypeVar("Task")
Result = TypeVar("Result")


class Spread(Protocol):
    """Yields ``work(task)`` of every task, in the order of the tasks, each as soon as it and all before it are done."""

    def __call__(self, work: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]: ...


class Code(NamedTuple):
    """The code that tasks run, which a worker on another machine has to have in the same state.

    Attributes:
        distribution: the name under which it is installed.
        packages: top-level packages with its sources.
    """

    distribution: str
    packages: tuple[str, ...]
