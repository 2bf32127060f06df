"""What spreads work, whatever does it; and what a worker elsewhere must have to do the work."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, Protocol, TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


class Spread(Protocol):
    """Yields ``work(task)`` of every task, in the order of the tasks, each as soon as it and all before it are done."""

    def __call__(self, work: Callable[[Task], Result], tasks: Sequence[Task]) -> Iterator[Result]: ...


class Code(NamedTuple):
    """The code that tasks run, which a worker on another machine has to have in the same state.

    Attributes:
        distribution: the name under which it is installed.
        packages: top-level packages with its sources.
    """

    distribution: str
    packages: tuple[str, ...]
