"""The recording of a run, encoded beside what the run still has to do.

Loading rerun takes longer than simulating a minute of six robots, and what is recorded is at hand in this process. So a
child of it, which inherits that, loads rerun and encodes while this one draws, and answers with the recording. Where a
process cannot have such a child, because it runs threads or has loaded rerun, it encodes the recording itself.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.abc import MetaPathFinder
from pathlib import Path
from types import TracebackType
from typing import IO, Any, cast

from rich.console import Console

from scenarios.recording import file

STANDARD = 3
"""Files that every process has: input, output, errors."""


class EncodingError(Exception):
    """A recording could not be made."""


class WithoutPandas(MetaPathFinder):
    """Has pandas not found: pyarrow loads it, to see whether a list is a series, which none here is.

    With None in its place among the modules pyarrow takes that for pandas, and blueprints lose what it was to convert.
    """

    def find_spec(self, fullname: str, *_: object) -> None:
        if fullname == "pandas":
            raise ModuleNotFoundError("recordings are encoded without pandas", name=fullname)


@contextmanager
def recording(path: Path, encode: Callable[[], bytes], console: Console) -> Iterator[None]:
    """Record in ``path`` what ``encode`` gives, beside the block. A run is whole without: replay rebuilds it."""
    with Encoder(encode) as encoder:
        yield
        try:
            file.write(path, encoder.content())
        except (OSError, EncodingError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            console.print(f"recording: cannot be written: {reason}; replay will rebuild it")


class Encoder:
    """What encodes a recording, from its begin to its end: a context manager that leaves no child behind."""

    def __init__(self, encode: Callable[[], bytes]) -> None:
        """Take what makes the content of the recording; it loads rerun itself."""
        self._encode = encode
        self._child: int | None = None
        self._answer: IO[bytes] | None = None

    def __enter__(self) -> Encoder:
        if _may_fork():
            answer, out = os.pipe()
            self._child = _fork(lambda: _answer(self._encode, out))
            os.close(out)
            self._answer = os.fdopen(answer, "rb")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._child is not None:
            with suppress(ProcessLookupError):
                os.kill(self._child, signal.SIGKILL)
            self._end()

    def content(self) -> bytes:
        """The content of the recording, when it is ready.

        Raises:
            EncodingError: it cannot be made, or the child was killed.
        """
        if self._child is None:
            try:
                return self._encode()
            except Exception as error:
                raise EncodingError(f"{type(error).__name__}: {error}") from error
        content = cast(IO[bytes], self._answer).read()
        if code := self._end():
            raise EncodingError(f"the process that encodes it ended with code {code}")
        return content

    def _end(self) -> int:
        """Wait for the child; its exit code, or minus the signal that ended it."""
        cast(IO[bytes], self._answer).close()
        _, status = os.waitpid(cast(int, self._child), 0)
        self._child = None
        return os.waitstatus_to_exitcode(status)


def _may_fork() -> bool:
    """A child has no thread but the one that made it: locks of others stay locked, and rerun has such threads."""
    return sys.platform == "linux" and threading.active_count() == 1 and "rerun" not in sys.modules


def _fork(work: Callable[[], Any]) -> int:
    """Do some work in a child, which ends with it; the number of the child."""
    with warnings.catch_warnings():
        # Python 3.12 counts the threads of OpenBLAS, which waits for its own before a process forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child:
        return child
    code = 1
    with suppress(BaseException):  # the parent is told by the code; what is wrong with a recording, `replay` tells
        work()
        code = 0
    os._exit(code)


def _answer(encode: Callable[[], bytes], out: int) -> None:
    """In the child: encode, and write the recording into a pipe."""
    os.setpgid(0, 0)  # an interrupt at the terminal is for the run, which ends this process
    for interrupt in (signal.SIGTERM, signal.SIGINT):
        signal.signal(interrupt, signal.SIG_DFL)
    # Locks and outputs are the run's: nobody is to wait for this process when the run was killed.
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(STANDARD):
        os.dup2(nothing, number)
    os.closerange(STANDARD, out)
    os.closerange(out + 1, os.sysconf("SC_OPEN_MAX"))
    gc.disable()  # what is made here is needed until the end: searching for garbage is time lost
    sys.meta_path.insert(0, WithoutPandas())
    with os.fdopen(out, "wb") as answer:
        answer.write(encode())
