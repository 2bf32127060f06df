"""Where work goes: processes of this machine, or the workers of a scheduler."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from scenarios.errors import InputError
from scenarios.work import processes
from scenarios.work.protocol import Code, Spread


@contextmanager
def spread(workers: int | None, scheduler: str | None, code: Code) -> Iterator[Spread]:
    """Processes of this machine, or the workers of a scheduler where its address is given.

    Args:
        workers: number of processes; None for one per processor.
        scheduler: ``tcp://host:port``; None for this machine.
        code: what the scheduler's workers have to have.

    Raises:
        InputError: both are given, or the scheduler cannot be used.
    """
    if scheduler is None:
        yield partial(processes.run_all, workers=workers or processes.available_workers())
        return
    if workers is not None:
        raise InputError("--workers: not together with --scheduler, which has its own")
    from scenarios.work import cluster  # only a scheduler needs it

    with cluster.connected(scheduler, code) as by_cluster:
        yield by_cluster
