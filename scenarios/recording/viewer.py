"""The rerun viewer as a program of its own. It listens on this machine alone: left to itself it listens everywhere.

Nothing here imports rerun, which takes longer than starting a process.
"""

from __future__ import annotations

import importlib.util
import shutil
import socket
import subprocess
import time
from pathlib import Path
from typing import NamedTuple

from scenarios.errors import InputError

LOOPBACK = "127.0.0.1"
PORT = 9876
"""Where a viewer listens unless told otherwise."""

START = 15.0
"""Seconds that a viewer may take to start."""


OPENING = 1.0
"""Seconds after which a viewer that listens has opened its window or ended."""


class Live(NamedTuple):
    """How a run is watched.

    Attributes:
        speed: simulated seconds per second.
        port: where the viewer listens on this machine.
    """

    speed: float = 1.0
    port: int = PORT


def executable() -> str:
    """The viewer that comes with the installed rerun-sdk, or the first on the path.

    Raises:
        InputError: there is none.
    """
    spec = importlib.util.find_spec("rerun_cli")
    folders = [str(Path(spec.origin).parent)] if spec is not None and spec.origin is not None else []
    for folder in (*folders, None):
        found = shutil.which("rerun", path=folder)
        if found is not None:
            return found
    raise InputError("rerun: the viewer is not installed, expected the package rerun-sdk")


def show(path: Path, web: bool) -> None:
    """Open a recording in a viewer, or in the browser, and wait until it is closed.

    Raises:
        InputError: the viewer did not open.
    """
    command = [executable(), str(path.resolve()), "--bind", LOOPBACK, "--port", "auto"]
    command += ["--web-viewer", "--web-viewer-port", "0"] if web else []
    code = subprocess.run(command, check=False).returncode
    if code != 0:
        hint = "" if web else "; without a screen, try --web"
        raise InputError(f"replay: the viewer ended with code {code}{hint}")


def listening(port: int) -> bool:
    """Whether something on this machine takes connections at ``port``."""
    with socket.socket() as probe:
        probe.settimeout(0.5)
        return probe.connect_ex((LOOPBACK, port)) == 0


def ready(port: int) -> bool:
    """Whether a viewer listens at ``port``; one is started if there is none."""
    if listening(port):
        return True
    command = [executable(), "--bind", LOOPBACK, "--port", str(port), "--expect-data-soon", "--hide-welcome-screen"]
    viewer = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # it outlives the run, and Ctrl-C is for the run alone
    )
    deadline = time.monotonic() + START
    while viewer.poll() is None and time.monotonic() < deadline:
        if listening(port):
            return _stays(viewer)
        time.sleep(0.05)
    return False


def _stays(viewer: subprocess.Popen[bytes]) -> bool:
    """Whether a viewer that listens goes on to open its window: without a screen it ends right after."""
    try:
        viewer.wait(OPENING)
    except subprocess.TimeoutExpired:
        return True
    return False
