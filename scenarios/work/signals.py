"""How a command ends when it is asked to: on SIGINT with exit code 130, on SIGTERM with 143, never with a traceback."""

from __future__ import annotations

import os
import signal
import sys

TYPE_CHECKING = False  # that of `typing`, which takes its time to load
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

INTERRUPTED, TERMINATED = 130, 143
"""Exit codes, as a shell counts ends by a signal."""

ASKED = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}


SOON = 0.01
"""Seconds after which a request to end that got lost is made again."""


class Terminated(BaseException):
    """The process was asked to end by SIGTERM. No error, so that nothing handles it but what tidies up."""


class _Requests:
    """What was asked of this process while work was under way.

    Attributes:
        asked: the last signal; None where there was none.
        held: how many blocks hold requests back.
        waiting: whether one waits for them.
    """

    asked: int | None = None
    held = 0
    waiting = False


_requests = _Requests()


class Held:
    """A context: what the block does is done whole, and a request to end waits for its end."""

    def __enter__(self) -> None:
        _requests.held += 1

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        _requests.held -= 1
        if _requests.waiting and not _requests.held:
            _requests.waiting = False
            _ask_again()


def exit_code() -> int | None:
    """The exit code of a process that was asked to end; None where it was not."""
    return None if _requests.asked is None else ASKED[signal.Signals(_requests.asked)]


def end_at_once() -> None:
    """While there is nothing to tidy up: the process ends where it is."""
    _handle(_end)


def end_in_order() -> None:
    """While work is under way: SIGINT raises KeyboardInterrupt, SIGTERM :class:`Terminated`, and scratch is removed."""
    _handle(_raise)
    signal.signal(signal.SIGALRM, _ask_again)
    sys.unraisablehook = _unraisable


def _handle(handler: Callable[[int, FrameType | None], None]) -> None:
    for number in ASKED:
        if signal.getsignal(number) != signal.SIG_IGN:  # as for jobs in the background of a script
            signal.signal(number, handler)


def _end(number: int, _: FrameType | None) -> None:
    os._exit(ASKED[signal.Signals(number)])


def _raise(number: int, _: FrameType | None) -> None:
    _requests.asked = number
    if _requests.held:
        _requests.waiting = True
        return
    raise KeyboardInterrupt if number == signal.SIGINT else Terminated


def _ask_again(*_: object) -> None:
    if _requests.asked is not None:
        _raise(_requests.asked, None)


def _unraisable(lost: sys.UnraisableHookArgs) -> None:
    """Where nothing can be raised, as in what C code calls back, Python drops a request to end: make it again."""
    if issubclass(lost.exc_type, KeyboardInterrupt | Terminated):
        signal.setitimer(signal.ITIMER_REAL, SOON)
    else:
        sys.__unraisablehook__(lost)
