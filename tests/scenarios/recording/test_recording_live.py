"""Runs that are watched: everything reaches a viewer, and nothing depends on one."""

import io
import os
import socket
import subprocess
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from rich.console import Console

from robots.testbed import COLLISION_DISTANCE
from scenarios.cli import cli
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.one_run import run_to_folder
from scenarios.recording import viewer
from scenarios.recording.file import damage
from scenarios.recording.live import FRAME, LiveView, viewer_at
from scenarios.recording.recorder import TIMELINE
from scenarios.recording.viewer import Live
from scenarios.recording.views import plots, timeline
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage import run_folder

Eventually = Callable[[Callable[[], set[int]], set[int]], set[int]]

FAST = 1e6
"""Simulated seconds per second: no waiting in tests."""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind((viewer.LOOPBACK, 0))
        return probe.getsockname()[1]


@contextmanager
def receiver(folder: Path) -> Iterator[tuple[subprocess.Popen[str], int, Path]]:
    """What takes a viewer's place without a screen: a server that saves what it gets. Sends no analytics."""
    port, saved = free_port(), folder / "received.rrd"
    command = [
        viewer.executable(),
        "--serve-grpc",
        "--bind",
        viewer.LOOPBACK,
        "--port",
        str(port),
        "--save",
        str(saved),
    ]
    environment = os.environ | {"CI": "true", "HOME": str(folder), "RUST_LOG": "info"}
    server = subprocess.Popen(
        command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
    )
    try:
        while "Listening" not in server.stdout.readline():
            assert server.poll() is None
        yield server, port, saved
    finally:
        server.terminate()
        server.communicate(timeout=10)


def received_rows(path: Path, entity: str) -> set[int]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a stream that was cut has no footer
        batches = [c.to_record_batch() for c in RrdReader(str(path)).stream() if c.entity_path == f"/{entity}"]
    return {t for b in batches if TIMELINE in b.schema.names for t in b.column(TIMELINE).cast("int64").to_pylist()}


def saved_rows(path: Path, entity: str) -> set[int]:
    """The rows that a receiver at work has saved by now: it writes its file when it gets to it."""
    with suppress(RuntimeError, ValueError):  # the file ends amid a message that is being written
        return received_rows(path, entity)
    return set()


def test_every_control_period_reaches_the_viewer(tmp_path: Path, eventually: Eventually) -> None:
    experiment = open_experiment("shape", ("safety.filter=none",), 3.0)
    with receiver(tmp_path) as (_, port, saved):
        view = LiveView(experiment, 0, viewer_at(port), FAST)
        trajectory = simulate(experiment, 0, on_state=view)
        assert view.finish(result(experiment, 0, trajectory, measure(experiment, trajectory)))
        nanoseconds = np.round(trajectory.t * 1e9).astype(int)
        periods = set(nanoseconds.tolist())
        assert eventually(lambda: saved_rows(saved, f"{plots.ERROR_SUM}/value"), periods) == periods
        near = measure(experiment, trajectory).separation.distance < COLLISION_DISTANCE
        changes = set(nanoseconds[np.append(True, near[1:] != near[:-1])].tolist())
        assert len(changes) > 1
        assert eventually(lambda: saved_rows(saved, timeline.DISTANCE), changes) == changes


def test_a_run_whose_viewer_is_killed_goes_on_and_keeps_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment = open_experiment("shape", (), 3.0)
    console = Console(record=True, file=io.StringIO(), width=400)
    watch = LiveView.__call__
    with receiver(tmp_path) as (server, port, _):

        def watch_and_kill(view: LiveView, trajectory: Trajectory, row: int) -> None:
            watch(view, trajectory, row)
            if row == 30:
                server.kill()
                server.wait(timeout=10)

        monkeypatch.setattr(LiveView, "__call__", watch_and_kill)
        run_to_folder(experiment, 0, tmp_path / "run", console, live=Live(FAST, port))
    assert "the viewer went away" in console.export_text()
    assert damage(tmp_path / "run" / run_folder.RECORDING) is None
    np.testing.assert_array_equal(run_folder.read(tmp_path / "run").trajectory.poses, simulate(experiment, 0).poses)


def test_a_run_without_any_viewer_says_so_and_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viewer, "ready", lambda port: False)
    console = Console(record=True, file=io.StringIO(), width=400)
    run_to_folder(open_experiment("shape", (), 1.0), 0, tmp_path / "run", console, live=Live())
    assert "live: no viewer" in console.export_text()
    assert damage(tmp_path / "run" / run_folder.RECORDING) is None


def test_a_viewer_that_cannot_start_is_no_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viewer, "executable", lambda: "false")
    assert not viewer.ready(free_port())


def test_a_viewer_without_a_screen_is_no_viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"CI": "true", "HOME": str(tmp_path)}.items():
        monkeypatch.setenv(name, value)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    assert not viewer.ready(free_port())


def test_a_watched_run_is_the_run(tmp_path: Path) -> None:
    experiment = open_experiment("shape", (), 2.0)
    with receiver(tmp_path) as (_, port, _):
        run_to_folder(experiment, 5, tmp_path / "run", Console(quiet=True), live=Live(FAST, port))
    alone = simulate(experiment, 5)
    np.testing.assert_array_equal(run_folder.read(tmp_path / "run").trajectory.poses, alone.poses)


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_a_watched_run_takes_its_time(speed: float, tmp_path: Path) -> None:
    experiment = open_experiment("shape", (), 1.0)
    now = [100.0]

    def sleep(seconds: float) -> None:
        assert seconds > 0.0
        now[0] += seconds

    view = LiveView(experiment, 0, rr.FileSink(str(tmp_path / "live.rrd")), speed, clock=lambda: now[0], sleep=sleep)
    trajectory = simulate(experiment, 0, on_state=view)
    assert now[0] - 100.0 == pytest.approx(trajectory.t[-1] / speed, abs=FRAME)


@pytest.mark.parametrize(
    "arguments",
    [
        ["replay", "no/such/run"],
        ["replay", "a", "b", "c"],
        ["run", "shape", "--speed", "2"],
        *(["run", "shape", "--live", "--speed", speed] for speed in ("nan", "inf", "0", "-1")),
    ],
)
def test_bad_arguments_are_refused(arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError):
        cli.main(arguments, standalone_mode=False)


@pytest.mark.parametrize("web", [False, True])
def test_viewers_are_told_to_listen_on_this_machine_alone(
    web: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands: list[list[str]] = []

    def run(command: list[str], check: bool) -> subprocess.CompletedProcess[bytes]:
        commands.append(command)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(viewer.subprocess, "run", run)
    monkeypatch.chdir(tmp_path)
    viewer.show(Path("-x") / "recording.rrd", web)
    (command,) = commands
    assert command[1] == str(tmp_path / "-x" / "recording.rrd")  # no option, whatever the folder's name
    assert command[command.index("--bind") + 1] == viewer.LOOPBACK
    assert ("--web-viewer" in command) == web


def test_a_viewer_that_fails_is_an_error_on_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failed: Callable[..., object] = lambda command, check: subprocess.CompletedProcess(command, 101)  # noqa: E731
    monkeypatch.setattr(viewer.subprocess, "run", failed)
    with pytest.raises(InputError, match="code 101"):
        viewer.show(tmp_path / "recording.rrd", web=False)
