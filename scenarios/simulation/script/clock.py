"""The clock of a script: the testbed's, on which a step takes 0.033 s, however fast it is simulated.

Scripts ask ``time.time()`` for how long they have been driving, and sleep. On the testbed and in the public simulator a
step waits for real time to pass; here nothing waits, so the clock is what goes on.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

READING = 1e-6
"""Seconds by which the clock goes on when it is read, so that who waits for it does not wait for ever."""


class StopScript(BaseException):
    """The time given to a script is over. Not an ``Exception``: scripts catch those."""


class Clock:
    """Simulated time, for the thread that drives the robots; to other threads it stands still while they sleep.

    Attributes:
        patience: seconds that a script may sleep between two steps: who sleeps longer than its robots may drive waits
            for something that never happens. None for as long as it likes.
    """

    def __init__(self, patience: float | None = None) -> None:
        self.patience, self._slept = patience, 0.0
        self._begin, self._begin_monotonic = time.time(), time.monotonic()
        self._passed = 0.0
        self._driver = threading.get_ident()
        self._sleep = time.sleep

    def tick(self, seconds: float) -> None:
        """Go on by one step of the robots."""
        self._driver = threading.get_ident()
        self._passed += seconds
        self._slept = 0.0

    def time(self) -> float:
        """In the place of ``time.time``."""
        self._passed += READING
        return self._begin + self._passed

    def monotonic(self) -> float:
        """In the place of ``time.monotonic``."""
        self._passed += READING
        return self._begin_monotonic + self._passed

    def sleep(self, seconds: float) -> None:
        """In the place of ``time.sleep``.

        Raises:
            StopScript: the script has slept for longer than :attr:`patience` since its last step.
        """
        if seconds < 0.0:
            raise ValueError("sleep length must be non-negative")
        if threading.get_ident() == self._driver:
            self._passed += seconds
            self._slept += seconds
            if self.patience is not None and self._slept > self.patience:
                raise StopScript
            self._sleep(0.0)
        else:
            self._sleep(min(seconds, 1e-3))  # wait for who drives, in real time

    @contextmanager
    def in_force(self) -> Iterator[None]:
        """Let the module ``time`` speak of this clock in this block."""
        before = {name: getattr(time, name) for name in ("time", "monotonic", "sleep")}
        try:
            for name in before:
                setattr(time, name, getattr(self, name))
            yield
        finally:
            for name, function in before.items():
                setattr(time, name, function)
