"""One command in this process, under limits, and what it must never do."""

from __future__ import annotations

import contextlib
import io
import math
import resource
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from unittest import mock

from scenarios.cli import BAD_INPUT, DONE, MISSED, main
from scenarios.simulation.compiling import ANNOUNCEMENT

PROCESSOR_SECONDS, SECONDS = 20.0, 300.0
"""Of one case; the second for what waits instead of working."""

MEMORY = 12 * 2**30
"""Bytes of address space: an allocation sized by input fails here."""

LONGEST_LINE = 700


class TooLong(BaseException):
    """A case that does not end."""


@dataclass(frozen=True)
class Answer:
    """What a command did: exit code, output, and the traceback that it should not have."""

    code: int
    out: str
    err: str
    raised: str = ""


@contextlib.contextmanager
def quick() -> Iterator[None]:
    """Nothing opens a window, and figures are left out but one: they take as long as all else."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    with (
        contextlib.ExitStack() as limits,
        mock.patch("scenarios.one_run._draw_overview"),
        mock.patch("scenarios.figures.names_for", return_value=["graph"]),
        mock.patch("scenarios.recording.viewer.show"),
        mock.patch("scenarios.recording.viewer.ready", return_value=False),
        warnings.catch_warnings(),
    ):
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, before[1]))
        limits.callback(resource.setrlimit, resource.RLIMIT_AS, before)
        warnings.simplefilter("always")
        yield


def command(*arguments: str) -> Answer:
    """Run the command line as ``formation ARGUMENTS``."""
    out, err, code, raised = io.StringIO(), io.StringIO(), DONE, ""
    signal.signal(signal.SIGALRM, _expire)
    signal.signal(signal.SIGVTALRM, _expire)
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    signal.setitimer(signal.ITIMER_VIRTUAL, PROCESSOR_SECONDS)
    try:
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            mock.patch.object(sys, "argv", ["formation", *arguments]),
            mock.patch("scenarios.terminal.SAID_EVERY", math.inf),  # how often it is said tells how busy a machine is
        ):
            main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else DONE
    except TooLong:
        raised = "too long"
    except BaseException:
        raised = traceback.format_exc()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    said = err.getvalue().removeprefix(f"{ANNOUNCEMENT}\n")  # the first command of a machine may say so
    return Answer(code, out.getvalue(), said, raised)


def complaint(answer: Answer, *named: str) -> str | None:
    """What is wrong with an answer; None where nothing is.

    Args:
        answer: of a command.
        named: a refusal has to name one of them: the file that is wrong, or an option.
    """
    if answer.raised:
        return answer.raised
    if answer.code not in (DONE, MISSED, BAD_INPUT):
        return f"exit code {answer.code}"
    if controls(answer.out + answer.err):
        return f"control characters: {answer.out!r} {answer.err!r}"
    if answer.code != BAD_INPUT:
        lines = [line for line in answer.err.splitlines() if not line.startswith("note: ")]
        return f"stderr: {answer.err}" if lines else None
    if not answer.err.startswith("formation: ") or answer.err.count("\n") != 1:
        return f"not one line: {answer.err!r}"
    if len(answer.err) > LONGEST_LINE:
        return f"a long line: {answer.err}"
    if not any(name in answer.err for name in named):
        return f"names neither file nor option: {answer.err}"
    return None


def controls(text: str) -> bool:
    """Whether a text holds what controls a terminal."""
    return any((c < " " and c != "\n") or "\x7f" <= c < "\xa0" for c in text)


def leftovers(folder: Path) -> list[str]:
    """Scratch that a command left."""
    return [str(path) for path in folder.rglob(".*") if path.name.endswith(".unfinished")]


def _expire(number: int, frame: FrameType | None) -> None:
    raise TooLong
