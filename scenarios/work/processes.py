"""Work spread over the processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import chain, islice

from scenarios.errors import InputError
from scenarios.work.protocol import AHEAD, Result, Task


def run_all(work: Callable[[Task], Result], tasks: Iterable[Task], workers: int) -> Iterator[Result]:
    """Yield ``work(task)`` of every task, in the order of the tasks, each as soon as it and all before it are done.

    Args:
        work: a function of a module; with more than one worker it runs in processes that import its module anew.
        tasks: what it is called with; taken as workers become free, at most :data:`AHEAD` per worker before their turn.
        workers: number of processes; 1 works in this one.

    Raises:
        InputError: a process was killed, for want of memory as a rule.
    """
    coming = iter(tasks)
    first = list(islice(coming, workers))
    if len(first) < 2:
        yield from map(work, chain(first, coming))
        return
    # Not forked: a copy of a process with threads (progress bars have one) may wait for a lock that nobody holds.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(len(first), context, _begin_worker)
    running: deque[Future[Result]] = deque()
    try:
        for task in chain(first, coming):
            with _without_interrupts():  # it starts a process while there are fewer than workers
                running.append(pool.submit(work, task))
            if len(running) == AHEAD * len(first):
                yield running.popleft().result()
        while running:
            yield running.popleft().result()
    except BrokenProcessPool as error:
        raise InputError(
            "--workers: a worker process was killed, for want of memory? expected fewer workers"
        ) from error
    except BaseException:  # interrupted, terminated, a task failed: what still runs is of no use
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def available_workers() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Processes that start in the block never see an interrupt: it ends the parent, which ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin_worker() -> None:
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker whose parent was killed would wait for work for ever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
