"""A sweep by a dask scheduler: the same rows, or one line that says what is wrong. Loopback alone, no dashboards."""

import builtins
import importlib.metadata
import operator
import os
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from scenarios.definition.load import LIBRARY
from scenarios.errors import InputError
from scenarios.studies.project import PROJECT
from scenarios.studies.sweep.folder import PARTIAL, ROWS, SUMMARY
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import open_study
from scenarios.studies.sweep.sweep import sweep
from scenarios.studies.sweep.variations import parse_variations
from scenarios.work import cluster, processes
from scenarios.work.spread import spread

SHORT = ("duration_s=0.5",)

Local = Callable[[int], str]


def in_threads(workers: int) -> LocalCluster:
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",  # a free port for what it serves besides
    )


@pytest.fixture
def local() -> Iterator[Local]:
    """Starts a scheduler with so many workers, all in this process, and gives its address."""
    running = []

    def start(workers: int) -> str:
        running.append(in_threads(workers))
        return running[-1].scheduler_address

    yield start
    for made in running:
        made.close()


@pytest.fixture(scope="module")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A scheduler and two workers, started by the commands of the documents in a folder of their own."""
    folder = tmp_path_factory.mktemp("cluster")
    options = ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]

    def dask(*arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments, *options],
            cwd=folder,
            env=os.environ | {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"},
            stderr=subprocess.PIPE,
            text=True,
        )

    with dask("scheduler", "--port", "0") as scheduler:
        said = iter(scheduler.stderr or ())
        [address] = next(found for line in said if (found := re.findall(r"Scheduler at: +(tcp://\S+)", line)))
        with dask("worker", address, "--nthreads", "1", "--nworkers", "2") as worker:
            yield address
            worker.terminate()
            worker.communicate()
        scheduler.terminate()
        scheduler.communicate()


def refused(address: str, *words: str) -> None:
    """One line with the address and all the words."""
    with pytest.raises(InputError) as caught, cluster.connected(address, PROJECT):
        pass
    message = str(caught.value)
    assert message.startswith(f"--scheduler {address}: ")
    assert "\n" not in message
    assert [word for word in words if word not in message] == []


# The same rows


def test_rows_are_those_of_one_process_bit_for_bit(local: Local, tmp_path: Path) -> None:
    study = open_study("shape", SHORT, parse_variations(["plant.name=pymunk,saturated"]), parse_seeds("0:3"))
    sweep(study, tmp_path / "here", partial(processes.run_all, workers=1), lambda *_: None)
    counts: list[tuple[int, int]] = []
    with spread(None, local(2), PROJECT) as run_all:
        sweep(study, tmp_path / "there", run_all, lambda *count: counts.append(count))
    for name in (ROWS, SUMMARY):
        assert (tmp_path / "there" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()
    assert counts == [(0, 6), (3, 6), (6, 6)]  # the runs of a plant are one task


def test_workers_need_no_file_and_a_lost_worker_loses_no_row(
    commands: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text((LIBRARY / "shape.toml").read_text(encoding="utf-8"), encoding="utf-8")
    study = open_study("mine.toml", (*SHORT, "safety.filter=none"), (), parse_seeds("0:6"))
    Path("mine.toml").unlink()
    sweep(study, tmp_path / "here", partial(processes.run_all, workers=1), lambda *_: None)
    with cluster.connected(commands, PROJECT) as run_all:
        [worker] = run_all(operator.call, [os.getpid])
        assert worker != os.getpid()

        def kill_it(done: int, total: int) -> None:
            if done == 2:
                os.kill(worker, signal.SIGKILL)

        sweep(study, tmp_path / "there", run_all, kill_it)
    assert (tmp_path / "there" / ROWS).read_bytes() == (tmp_path / "here" / ROWS).read_bytes()


def test_a_run_that_kills_every_worker_is_named(commands: str) -> None:
    with (
        cluster.connected(commands, PROJECT) as run_all,
        pytest.raises(InputError, match=r": 9: its worker was killed 2 times"),
    ):
        list(run_all(signal.raise_signal, [signal.SIGKILL]))


# What a task does reaches the caller


def test_results_come_in_the_order_of_the_tasks_as_soon_as_they_are_there(local: Local) -> None:
    held = threading.Event()

    def work(task: int) -> int:
        assert task != 1 or held.wait(20)
        return task

    with cluster.connected(local(2), PROJECT) as run_all:
        results = run_all(in_process(work), list(range(6)))
        assert next(results) == 0
        held.set()  # not before the first one is here
        assert list(results) == [1, 2, 3, 4, 5]


def test_errors_of_a_task_arrive_as_they_are(local: Local) -> None:
    with cluster.connected(local(1), PROJECT) as run_all:
        with pytest.raises(TimeoutError, match="its own"):
            list(run_all(in_process(raising(TimeoutError("its own"))), [0]))
        with pytest.raises(InputError, match="agents: too many"):
            list(run_all(in_process(raising(InputError("agents: too many"))), [0]))
        with pytest.raises(InputError, match=r"--scheduler .*: seed 7: its worker lacks a package: .*pymunk"):
            list(run_all(in_process(raising(ModuleNotFoundError("No module named 'pymunk'"))), ["seed 7"]))


def test_an_interrupt_drops_what_is_queued_and_keeps_the_finished_rows(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    eventually: Callable[[Callable[[], list[str]], list[str]], list[str]],
) -> None:
    begun: list[int] = []
    runs = sys.modules["scenarios.studies.sweep.row"].Runs
    monkeypatch.setattr("scenarios.studies.sweep.study.MOST_WATCHED", 1)
    monkeypatch.setattr(
        "scenarios.studies.sweep.row.Runs",
        lambda experiment, seeds: begun.extend(seeds) or runs(experiment, seeds),
    )

    def interrupt(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    study = open_study("shape", SHORT, (), parse_seeds("0:300"))
    with in_threads(1) as made:
        with pytest.raises(KeyboardInterrupt), cluster.connected(made.scheduler_address, PROJECT) as run_all:
            sweep(study, tmp_path, run_all, interrupt)
        assert eventually(lambda: [name for name in made.scheduler.clients if name.startswith("Client")], []) == []
    assert len((tmp_path / PARTIAL).read_text(encoding="utf-8").splitlines()) == 1 + 2
    assert not (tmp_path / ROWS).exists()
    assert 2 <= len(begun) < 100


def test_a_scheduler_that_goes_away_and_workers_that_all_go_away_are_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cluster, "ARRIVING", 0.5)
    with in_threads(1) as made, cluster.connected(made.scheduler_address, PROJECT) as run_all:
        made.sync(made.workers[0].close)
        with pytest.raises(InputError, match=r"no worker left for 0.5 s, start one with `dask worker tcp://"):
            list(run_all(abs, [-1]))
    made = in_threads(1)
    with cluster.connected(made.scheduler_address, PROJECT) as run_all:
        made.sync(made.workers[0].close)
        monkeypatch.setattr(cluster, "ARRIVING", 20.0)
        closing = threading.Timer(0.2, made.close)  # while the task waits for a worker
        closing.start()
        with pytest.raises(InputError, match="the connection to the scheduler was lost"):
            list(run_all(abs, [-1]))
        closing.join()


# What is refused


@pytest.mark.parametrize(
    "address", ["", "here", "localhost:8786", "tcp://", "tcp://:8786", "tcp://host", "tcp://host:0", "tcp://host:99999",
                "http://host:80", "tcp://host:8786/x", "tcp://[::1"],
)  # fmt: skip
def test_an_address_that_is_none_is_refused_before_anything_is_asked(address: str) -> None:
    refused(address, "expected an address like tcp://")


def test_workers_and_a_scheduler_exclude_each_other() -> None:
    with (
        pytest.raises(InputError, match="--workers: not together with --scheduler"),
        spread(2, "tcp://host:1", PROJECT),
    ):
        pass


def test_a_missing_package_is_told_with_the_extra_that_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    load = builtins.__import__

    def without_dask(name: str, *arguments: Any) -> Any:
        if name.startswith(("dask", "distributed")):
            raise ModuleNotFoundError(f"No module named {name!r}")
        return load(name, *arguments)

    monkeypatch.setattr(builtins, "__import__", without_dask)
    with (
        pytest.raises(InputError, match=r"package distributed, the extra 'cluster' of angle-formation"),
        cluster.connected("tcp://a:1", PROJECT),
    ):
        pass


def test_silence_and_a_closed_port_are_told_within_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "CONNECTING", 1.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        refused(address, "no answer within 1.5 s")
    refused(address, "Timed out trying to connect")


def test_a_scheduler_without_workers_and_a_worker_instead_of_one_are_told(
    local: Local, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "ARRIVING", 0.2)
    empty = local(0)
    refused(empty, "has no workers after 0.2 s", f"dask worker {empty}")
    with in_threads(1) as made:
        [worker] = made.scheduler_info["workers"]
        refused(worker, "expected a scheduler there, found a Worker")


def test_another_version_or_none_on_a_worker_is_told_with_both(local: Local, monkeypatch: pytest.MonkeyPatch) -> None:
    address, version = local(1), importlib.metadata.version
    here = version("angle-formation")

    def elsewhere(name: str) -> str:
        if threading.current_thread() is threading.main_thread():
            return version(name)
        return "0.0.9"

    monkeypatch.setattr(importlib.metadata, "version", elsewhere)
    refused(address, "has angle-formation 0.0.9", f"expected {here} as here")

    def nowhere(name: str) -> str:
        if threading.current_thread() is threading.main_thread():
            return version(name)
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", nowhere)
    refused(address, "has no angle-formation", f"expected {here} as here")


def test_other_sources_are_told_before_a_run_and_also_by_a_worker_that_comes_later(
    local: Local, monkeypatch: pytest.MonkeyPatch
) -> None:
    def differing(packages: tuple[str, ...]) -> str:
        return "here" if threading.current_thread() is threading.main_thread() else "there"

    address = local(1)
    with cluster.connected(address, PROJECT) as run_all:
        monkeypatch.setattr(cluster, "sources", differing)
        with pytest.raises(InputError, match=r"a worker that came later has .* with other sources"):
            list(run_all(in_process(abs), [-1]))
    refused(address, "with other sources than here")


def in_process(work: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function that travels within this process as the same object."""
    return SameObject(work)


def raising(error: Exception) -> Callable[[Any], Any]:
    def work(task: object) -> None:
        raise error

    return work


KNOWN: dict[int, Callable[[Any], Any]] = {}


class SameObject:
    """Calls a function of this process, wherever in this process it was unpacked."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        KNOWN[id(work)] = work
        self.place = id(work)

    def __call__(self, task: object) -> object:
        return KNOWN[self.place](task)
