"""How a command ends when it is asked to: on SIGINT with exit code 130, on SIGTERM with 143, never with a traceback."""

from __future__ import annotations

import os
import signal

TYPE_CHECKING = False  # that of `typing`, which takes its time to load
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

INTERRUPTED, TERMINATED = 130, 143
"""Exit codes, as a shell counts ends by a signal."""

ASKED = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}


class Terminated(BaseException):
    """The process was asked to end by SIGTERM. No error, so that nothing handles it but what tidies up."""


def end_at_once() -> None:
    """While there is nothing to tidy up: the process ends where it is."""
    _handle(_end)


def end_in_order() -> None:
    """While work is under way: SIGINT raises KeyboardInterrupt, SIGTERM :class:`Terminated`, and scratch is removed."""
    _handle(_raise)


def _handle(handler: Callable[[int, FrameType | None], None]) -> None:
    for number in ASKED:
        if signal.getsignal(number) != signal.SIG_IGN:  # as for jobs in the background of a script
            signal.signal(number, handler)


def _end(number: int, _: FrameType | None) -> None:
    os._exit(ASKED[signal.Signals(number)])


def _raise(number: int, _: FrameType | None) -> None:
    raise KeyboardInterrupt if number == signal.SIGINT else Terminated
