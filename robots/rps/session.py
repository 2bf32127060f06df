"""How the robots of a script are simulated, and who watches: what a script cannot say, because it knows one testbed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from robots.measured import MeasuredModel
    from robots.rps.robotarium import Robotarium

Start = Literal["exact", "near", "driven"]
"""At the initial conditions; as near as the testbed brings them; driven there from their chargers as on the testbed."""


def _nobody(robots: Robotarium) -> None:
    """Watch nothing."""


def _nowhere(text: str) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Session:
    """One way of running scripts.

    Attributes:
        plant: ``unicycle``, ``saturated`` or ``pymunk``; see :mod:`robots.worlds`.
        start: how robots come to their initial conditions.
        start_draws: where ``near`` gets its errors from: not from the generator that the script draws from.
        begun: called with every set of robots when it stands at its start.
        stepped: called with it after every step.
        told: called with remarks that are for the person, not for the script.
        on_screen: whether figures are shown while the script runs.
        measured: the robots as logs and firmware show them; None for the data sheet's.
    """

    plant: str = "pymunk"
    start: Start = "exact"
    start_draws: np.random.Generator | None = None
    begun: Callable[[Robotarium], None] = _nobody
    stepped: Callable[[Robotarium], None] = _nobody
    told: Callable[[str], None] = _nowhere
    on_screen: bool = False
    measured: MeasuredModel | None = None


_running = [Session()]


def current() -> Session:
    """The session under way; one that nobody watches where there is none."""
    return _running[-1]


@contextmanager
def during(session: Session) -> Iterator[None]:
    """Robots made in this block belong to ``session``."""
    _running.append(session)
    try:
        yield
    finally:
        _running.remove(session)
