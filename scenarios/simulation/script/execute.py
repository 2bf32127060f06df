"""Run a script for the Robotarium as ``python FILE.py`` would, over our worlds, until it ends in one way or another."""

from __future__ import annotations

import os
import random
import runpy
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, NoReturn

import numpy as np

import robots
import scenarios
from robots.model import CONTROL_PERIOD
from robots.rps.hook import serving
from robots.rps.robotarium import Robotarium
from robots.rps.session import Session, during
from scenarios.simulation.script.clock import Clock, StopScript
from scenarios.simulation.script.hints import hint
from scenarios.simulation.script.script_file import ScriptFile

Outcome = Literal["ended", "exited", "raised", "interrupted", "stopped"]

OURS = tuple(str(Path(path).resolve()) for room in (robots, scenarios) for path in room.__path__)
POLL = 0.1
"""Seconds between two looks at whether threads of a script have ended."""


@dataclass(frozen=True, eq=False)
class Ending:
    """How a script ended.

    Attributes:
        outcome: ``ended`` at its last line; ``exited`` by ``exit()``; ``raised`` what it did not catch; ``interrupted``
            from the keyboard; ``stopped`` when its time was over.
        code: what it gave to ``exit()``, 0 for nothing.
        text: for people: the traceback of an error through the script's own lines, or what was given to ``exit()``.
        advice: what to do about it, in one line, where that is known.
        robots: every set of robots that it made, in their order.
    """

    outcome: Outcome
    code: int
    text: str
    advice: str | None
    robots: tuple[Robotarium, ...]


def execute(
    file: ScriptFile,
    arguments: Sequence[str],
    session: Session,
    seed: int,
    duration: float | None = None,
) -> Ending:
    """Run a script.

    Args:
        file: the script.
        arguments: what it finds in ``sys.argv`` after its name.
        session: how its robots are simulated.
        seed: of numpy's and Python's global generators when it begins.
        duration: simulated seconds after which its robots take no further step, and that it may sleep between two;
            None for no end.
    """
    made: list[Robotarium] = []
    clock, threads = Clock(duration), set(threading.enumerate())

    def begun(robots: Robotarium) -> None:
        made.append(robots)
        session.begun(robots)

    def stepped(robots: Robotarium) -> None:
        clock.tick(CONTROL_PERIOD)
        session.stepped(robots)
        if duration is not None and robots.steps * CONTROL_PERIOD >= duration:
            raise StopScript

    watched = replace(session, begun=begun, stepped=stepped)
    with _as_python_would(file.path, arguments, seed), serving(file.version, file.path), during(watched):
        try:
            with clock.in_force(), _leaving_in_order(), _children_as_python_has_them():
                runpy.run_path(str(file.path), run_name="__main__")
                _wait_for_threads(threads)
        except StopScript:
            return Ending("stopped", 0, "", None, tuple(made))
        except KeyboardInterrupt:
            return Ending("interrupted", 0, "", None, tuple(made))
        except SystemExit as end:
            code, text = _exit(end)
            return Ending("exited", code, text, None, tuple(made))
        except BaseException as error:  # whatever a script raises is its outcome
            return Ending("raised", 1, through_the_script(error), hint(error), tuple(made))
    return Ending("ended", 0, "", None, tuple(made))


def through_the_script(error: BaseException) -> str:
    """The traceback of an error, without the lines that are ours."""
    told = traceback.TracebackException.from_exception(error)
    seen: set[int] = set()
    link: traceback.TracebackException | None = told
    while link is not None and id(link) not in seen:
        seen.add(id(link))
        frames = [frame for frame in link.stack if not _is_ours(frame.filename)]
        link.stack = traceback.StackSummary.from_list(frames)
        link = link.__cause__ or link.__context__
    return "".join(told.format()).rstrip()


@contextmanager
def _as_python_would(script: Path, arguments: Sequence[str], seed: int) -> Iterator[None]:
    """``sys.argv``, ``sys.path``, warnings and global generators as at the start of ``python FILE.py``."""
    folder = str(script.resolve().parent)
    argv, path, modules = sys.argv, list(sys.path), set(sys.modules)
    numpy_before, python_before = np.random.get_state(), random.getstate()  # noqa: NPY002
    try:
        sys.argv, sys.path[:] = [str(script), *arguments], [folder, *sys.path]
        np.random.seed(seed % 2**32)  # noqa: NPY002 scripts draw from the global generators
        random.seed(seed)
        with warnings.catch_warnings():
            warnings.simplefilter("default")
            warnings.filterwarnings("ignore", category=DeprecationWarning)
            for quiet in (PendingDeprecationWarning, ImportWarning, ResourceWarning):
                warnings.filterwarnings("ignore", category=quiet)
            yield
    finally:
        sys.argv, sys.path[:] = argv, path
        np.random.set_state(numpy_before)  # noqa: NPY002
        random.setstate(python_before)
        for name in set(sys.modules) - modules:
            if str(getattr(sys.modules[name], "__file__", None) or "").startswith(folder):
                del sys.modules[name]


@contextmanager
def _leaving_in_order() -> Iterator[None]:
    """``os._exit`` ends the script, as ``exit`` does, and not us; in its threads and processes it is as ever."""
    leave, process = os._exit, os.getpid()

    def leave_in_order(status: int) -> NoReturn:
        if os.getpid() == process and threading.current_thread() is threading.main_thread():
            raise SystemExit(status)
        leave(status)

    os._exit = leave_in_order
    try:
        yield
    finally:
        os._exit = leave


@contextmanager
def _children_as_python_has_them() -> Iterator[None]:
    """Processes that a script makes end on a signal as Python's do: how we are asked to end is not their matter."""
    from multiprocessing.util import register_after_fork

    class Mark:
        """Lives as long as the block, and with it what was registered."""

    def plain(_: Mark) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)

    mark = Mark()
    register_after_fork(mark, plain)
    yield
    del mark


def _wait_for_threads(before: set[threading.Thread]) -> None:
    """Wait for threads that were not there before, as Python does at its end; the keyboard can interrupt it."""
    while waiting := [each for each in threading.enumerate() if not each.daemon and each not in before]:
        waiting[0].join(POLL)


def _exit(end: SystemExit) -> tuple[int, str]:
    if end.code is None or isinstance(end.code, int):
        return int(end.code or 0), ""
    return 1, str(end.code)


def _is_ours(filename: str) -> bool:
    return filename.startswith(OURS) or filename.startswith("<frozen runpy") or filename.endswith("/runpy.py")
