"""The recording of a run, encoded in a process beside the one that runs.

Loading rerun takes about as long as simulating a minute of six robots. A second process does that while the first one
simulates, and encodes while the first one draws. It is told the run folder on its input, answers with the recording on
its output, and ends when its input does: with the run, however that ends.
"""

from __future__ import annotations

import errno
import gc
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, cast


class Encoder:
    """The process; a context manager that leaves none behind."""

    def __enter__(self) -> Encoder:
        # -P: a folder named `scenarios` where the user works is not this package. A group of its own: an interrupt at
        # the terminal is for the run, which ends this process.
        command = [sys.executable, "-P", "-m", __name__]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, process_group=0)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._process.kill()
        with self._process:  # closes the pipes and waits
            pass

    def begin(self, folder: Path) -> None:
        """Encode the run in ``folder``, which has all files but the recording."""
        stdin = cast(IO[bytes], self._process.stdin)
        with suppress(BrokenPipeError):  # that the process is gone is found out when the recording is asked for
            stdin.write(os.fsencode(folder.resolve()))
            stdin.close()

    def recording(self) -> bytes:
        """The content of the recording, when it is ready.

        Raises:
            ChildProcessError: the process was killed or failed.
        """
        content = cast(IO[bytes], self._process.stdout).read()
        if code := self._process.wait():
            raise ChildProcessError(errno.ECHILD, f"the process that encodes it ended with code {code}")
        return content


def main() -> None:
    """Get ready, read the name of a run folder, write its recording."""
    gc.disable()  # what it makes is needed until it ends, so that searching for garbage is time lost
    from scenarios.recording.content import recording_of

    if folder := sys.stdin.buffer.read():
        sys.stdout.buffer.write(recording_of(Path(os.fsdecode(folder)), under_way=True))


if __name__ == "__main__":
    main()
