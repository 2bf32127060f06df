"""The recording of a run, encoded in a process beside the one that runs.

Loading rerun takes about as long as two minutes of six robots. A second process does that while the first one
simulates, and encodes while the first one draws.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from scenarios import run_folder
from scenarios.pool import begin_worker

Encode = Callable[[Path], "Future[bytes]"]
"""Takes a folder with the files of a run, gives the content of its recording, later."""


@contextmanager
def encoder() -> Iterator[Encode]:
    """Start the process; it gets ready by itself and ends with the block."""
    pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), begin_worker)
    try:
        pool.submit(_get_ready)
        yield partial(_later, pool)
    finally:
        pool.shutdown(cancel_futures=True)


def _later(pool: ProcessPoolExecutor, folder: Path) -> Future[bytes]:
    try:
        return pool.submit(_encode, folder)
    except BrokenProcessPool as error:  # killed while it got ready
        failed: Future[bytes] = Future()
        failed.set_exception(error)
        return failed


def _get_ready() -> None:
    import scenarios.recording.encode  # noqa: F401 (loads rerun)


def _encode(folder: Path) -> bytes:
    from scenarios.recording.encode import encode_run

    return encode_run(run_folder.read(folder))
