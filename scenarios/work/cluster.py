"""Work spread over the workers of a running dask.distributed scheduler."""

from __future__ import annotations

import asyncio
import hashlib
import importlib.metadata
import importlib.util
import logging
import uuid
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from scenarios.errors import InputError
from scenarios.work.protocol import AHEAD, Code, Result, Spread, Task

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECTING = 10.0
"""Seconds that the scheduler has to answer."""

ARRIVING = 30.0
"""Seconds that a first worker has to arrive, and in mid-run another one where the last is gone."""

START_WORKERS = "start one with `dask worker {} --nthreads 1`"


@contextmanager
def connected(address: str, code: Code) -> Iterator[Spread]:
    """What :func:`scenarios.work.processes.run_all` does, by the workers of a scheduler. Leaving drops what is queued.

    A worker needs the code, in the same state; tasks carry all else, so that no file has to be there.

    Args:
        address: of the scheduler, ``tcp://host:port`` or ``tls://host:port``.
        code: what the workers have to have.

    Raises:
        InputError: the package is missing, the address is none or no scheduler answers there, it has no workers, or
            one of them does not have the same version and sources of the code.
    """
    _check_address(address)
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError(
            f"--scheduler: needs the package distributed, the extra 'cluster' of {code.distribution} ({error})"
        ) from error
    with _silent(), ExitStack() as stack:
        with _located(address):
            _check_scheduler(address)
            client = Client(address, timeout=CONNECTING, set_as_default=False)
            stack.callback(client.close, CONNECTING)  # upon which the scheduler drops what is queued
            _check_workers(client, address, code)
        yield partial(_run_all, client, address, code)


def _run_all(
    client: Client, address: str, code: Code, work: Callable[[Task], Result], tasks: Iterable[Task]
) -> Iterator[Result]:
    run = partial(_run_here, work, code, sources(code.packages))
    running: deque[tuple[Task, Future[Any]]] = deque()
    with _located(address):
        ahead = AHEAD * max(1, sum(client.nthreads().values()))
    for task in tasks:
        running.append((task, client.submit(run, task, key=f"formation-{uuid.uuid4().hex}")))
        if len(running) >= ahead:
            yield _result(client, address, *running.popleft())
    while running:
        yield _result(client, address, *running.popleft())


def _result(client: Client, address: str, task: Task, future: Future[Any]) -> Any:
    from distributed import KilledWorker

    error = _wait(client, address, future)
    if isinstance(error, KilledWorker):
        times = error.allowed_failures + 1
        raise InputError(
            f"--scheduler {address}: {task}: its worker was killed {times} times, for want of memory?"
        ) from error
    if isinstance(error, ModuleNotFoundError):
        raise InputError(f"--scheduler {address}: {task}: its worker lacks a package: {error}") from error
    if error is not None:
        raise error.with_traceback(future.traceback())
    with _located(address):
        result = future.result()
    future.release()
    return result


def _run_here(work: Callable[[Task], Result], code: Code, expected: str, task: Task) -> Result:
    """On a worker, which may have come after the others were asked for their sources."""
    if sources(code.packages) != expected:
        raise InputError(f"--scheduler: a worker that came later has {_another_state(code)}")
    return work(task)


def _wait(client: Client, address: str, future: Future[Any]) -> BaseException | None:
    """The error that the future ends with, if any, once it ends. Waits as long as there are workers."""
    with _located(address):
        while True:
            try:
                error = future.exception(timeout=ARRIVING)
            except TimeoutError:
                if not client.nthreads():
                    raise InputError(
                        f"--scheduler {address}: no worker left for {ARRIVING:g} s, {START_WORKERS.format(address)}"
                    ) from None
            else:
                if isinstance(error, CancelledError):  # nobody here cancels: the scheduler is gone
                    raise error
                return error


@cache  # a worker that has loaded the code keeps running it, whatever becomes of its files
def sources(packages: tuple[str, ...]) -> str:
    """Digest of the packages' code as this process first saw it: a version number does not change with every edit."""
    digest = hashlib.sha256()
    for package in packages:
        spec = importlib.util.find_spec(package)
        for folder in map(Path, (spec and spec.submodule_search_locations) or ()):
            for path in sorted(folder.rglob("*.py")):
                name = f"{package}/{path.relative_to(folder).as_posix()}"
                digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _check_address(address: str) -> None:
    try:
        parts = urlsplit(address)
        usable = parts.scheme in ("tcp", "tls") and parts.hostname and parts.port and not parts.path + parts.query
    except ValueError:  # a port that is none
        usable = False
    if not usable:
        raise InputError(f"--scheduler {address[:80]}: expected an address like tcp://192.168.0.1:8786")


def _check_scheduler(address: str) -> None:
    """Dask itself waits for ever for something that takes a connection and says nothing."""
    from distributed.core import rpc
    from distributed.security import Security

    async def identity() -> Mapping[str, Any]:
        async with asyncio.timeout(CONNECTING):
            # The extra second lets dask's own reason come first.
            async with rpc(
                address, timeout=CONNECTING - 1.0, connection_args=Security().get_connection_args("client")
            ) as server:
                return dict(await server.identity())

    found = asyncio.run(identity()).get("type")
    if found != "Scheduler":
        raise InputError(f"--scheduler {address}: expected a scheduler there, found a {found}")


def _check_workers(client: Client, address: str, code: Code) -> None:
    try:
        client.wait_for_workers(1, ARRIVING)
    except TimeoutError:
        raise InputError(
            f"--scheduler {address}: has no workers after {ARRIVING:g} s, {START_WORKERS.format(address)}"
        ) from None
    name, here = code.distribution, importlib.metadata.version(code.distribution)
    # Functions of the standard library first: they are there where the code is not.
    for place, found in _ask(client, importlib.metadata.version, name):
        if isinstance(found, importlib.metadata.PackageNotFoundError):
            raise InputError(f"--scheduler {address}: {place} has no {name}, expected {here} as here")
        if found != here:
            raise InputError(f"--scheduler {address}: {place} has {name} {found}, expected {here} as here")
    for place, found in _ask(client, sources, code.packages):
        if found != sources(code.packages):
            raise InputError(f"--scheduler {address}: {place} has {_another_state(code)}")


def _ask(client: Client, function: Callable[..., str], *arguments: Any) -> Iterator[tuple[str, Any]]:
    """The answers of the scheduler, which unpacks what it passes on, and of all workers."""
    try:
        yield "the scheduler", client.run_on_scheduler(function, *arguments)
    except (ImportError, AttributeError) as error:
        yield "the scheduler", error
    for worker, found in client.run(function, *arguments, on_error="return").items():
        yield f"the worker {worker}", found


def _another_state(code: Code) -> str:
    version = importlib.metadata.version(code.distribution)
    return f"{code.distribution} {version} with other sources than here; update and restart it"


@contextmanager
def _located(address: str) -> Iterator[None]:
    """Dask's own errors on one line."""
    try:
        yield
    except TimeoutError as error:
        raise InputError(f"--scheduler {address}: no answer within {CONNECTING:g} s") from error
    except CancelledError as error:
        raise InputError(f"--scheduler {address}: the connection to the scheduler was lost") from error
    except OSError as error:
        raise InputError(f"--scheduler {address}: {error.strerror or error}") from error


@contextmanager
def _silent() -> Iterator[None]:
    """Dask tells on stderr, at length, what is told here in one line."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", module="distributed")
            yield
    finally:
        logging.disable(before)
