"""Pictures of the real viewer for docs/recording.md: ``make screenshots``. Needs xvfb, Vulkan in software and chromium.

The native viewer is steered to a time and asked for its picture; the web viewer runs in a headless browser. All
processes get an own home folder and are told not to send analytics.
"""

import base64
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from rerun.experimental import ViewerClient
from rich.console import Console

from scenarios.definition.experiment import open_experiment
from scenarios.one_run import run_to_folder
from scenarios.recording.encode import encode_pair
from scenarios.recording.file import write
from scenarios.recording.recorder import TIMELINE
from scenarios.recording.viewer import LOOPBACK, executable, listening
from scenarios.storage import run_folder

SIZE = (1400, 800)
IMAGES = Path(__file__).parent / "images"

PICTURES = {"shape": 5.0, "maneuver": 60.0, "pair": 55.0, "obstacles": 5.0, "crowd": 20.0}
"""Recordings, and the times at which each has its picture taken in the middle of the run, seconds."""

PAINTED = 2.0
"""Seconds that a viewer without a graphics card takes to draw a frame that has settled."""

BROWSER = 25.0
"""Seconds that a browser without a graphics card takes to load the viewer and a recording."""


MIDDLE, EARLY, NEAR, LEGEND, WALLS = (743.0, 785.0), (350.0, 785.0), (185.0, 51.0), (480.0, 527.0), (650.0, 527.0)
"""Places in a window of that size, pixels: two on the time bar, and titles of views that lie behind others."""

BROWSED = {"maneuver": [MIDDLE, NEAR, LEGEND], "obstacles": [EARLY, NEAR, WALLS]}
"""Recordings in the browser, and what is clicked on before each has its picture taken."""


def main() -> None:
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="formation-screenshots-") as scratch:
        folder = Path(scratch)
        environment = os.environ | {"CI": "true", "HOME": scratch}
        for name, path in recordings(folder).items():
            with viewer(path, environment) as port:
                client = ViewerClient.connect(f"rerun+http://{LOOPBACK}:{port}/proxy")
                client.set_time(TIMELINE, duration=PICTURES[name], play_state="paused")
                time.sleep(PAINTED)
                picture = folder / "picture.png"
                client.save_screenshot(str(picture))
                keep(picture, f"recording-{name}-middle.png")
            if name in BROWSED:
                browse(name, path, folder, environment)


def recordings(folder: Path) -> dict[str, Path]:
    """A shape run, a maneuver, and it with and without safety filter beside each other; obstacles, and fifty robots."""
    for name, scenario, changes in (
        ("shape", "shape", ()),
        ("maneuver", "maneuver", ()),
        ("literal", "maneuver", ("safety.filter=none",)),
        ("obstacles", "obstacles", ()),
        ("crowd", "random-50", ()),
    ):
        run_to_folder(open_experiment(scenario, changes), 0, folder / name, Console(quiet=True))
    write(folder / "pair.rrd", encode_pair([run_folder.read(folder / name) for name in ("maneuver", "literal")]))
    single = {name: folder / name / run_folder.RECORDING for name in ("shape", "maneuver", "obstacles", "crowd")}
    return single | {"pair": folder / "pair.rrd"}


@contextmanager
def viewer(path: Path, environment: dict[str, str]) -> Iterator[int]:
    """A native viewer with a recording, on a screen in memory that is larger, so that the pointer is elsewhere."""
    port = free_port()
    screen = ["xvfb-run", "-a", "-s", f"-screen 0 {3 * SIZE[0]}x{3 * SIZE[1]}x24"]
    command = [executable(), str(path), "--bind", LOOPBACK, "--port", str(port), "--window-size", "{}x{}".format(*SIZE)]
    with running(screen + command, environment, port):
        time.sleep(6.0 * PAINTED)  # a recording of fifty robots takes a while to arrive
        yield port


def browse(run: str, path: Path, folder: Path, environment: dict[str, str]) -> None:
    """Take the web viewer's picture after clicks on its time bar and on titles of views."""
    port, web = free_port(), free_port()
    command = [executable(), str(path), "--serve-web", "--bind", LOOPBACK]
    command += ["--port", str(port), "--web-viewer-port", str(web)]
    with running(command, environment, web), Browser(folder / f"browser-{run}", environment) as browser:
        browser.call(
            "Page.navigate", url=f"http://{LOOPBACK}:{web}/?url=rerun%2Bhttp%3A%2F%2F{LOOPBACK}%3A{port}%2Fproxy"
        )
        time.sleep(BROWSER)
        for x, y in BROWSED[run]:
            for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
                button = {"button": "none"} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
                browser.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)
                time.sleep(PAINTED)
        picture = folder / "web.png"
        picture.write_bytes(base64.b64decode(browser.call("Page.captureScreenshot")["data"]))
        keep(picture, f"recording-web-{run}-near.png")


class Browser:
    """A headless chromium with one page, driven by DevTools messages over a pair of pipes (its descriptors 3 and 4)."""

    def __init__(self, profile: Path, environment: dict[str, str]) -> None:
        self._command = ["chromium", "--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader"]
        self._command += ["--hide-scrollbars", f"--user-data-dir={profile}", "--window-size={},{}".format(*SIZE)]
        self._command += ["--remote-debugging-pipe", "about:blank"]
        self._environment = environment
        self._session: dict[str, str] = {}
        self._number = 0

    def __enter__(self) -> "Browser":
        (take, self._write), (self._read, give) = os.pipe(), os.pipe()
        shell = ["bash", "-c", f'exec 3<&{take} 4>&{give}; exec "$@"', "bash", *self._command]
        self._process = subprocess.Popen(
            shell, env=self._environment, pass_fds=(take, give), start_new_session=True, stderr=subprocess.DEVNULL
        )
        os.close(take)
        os.close(give)
        page = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self._session = {
            "sessionId": self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        }
        self.call(
            "Emulation.setDeviceMetricsOverride", width=SIZE[0], height=SIZE[1], deviceScaleFactor=1, mobile=False
        )
        return self

    def __exit__(self, *_: object) -> None:
        os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait()
        os.close(self._write)
        os.close(self._read)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a message and wait for its answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters, **self._session}
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = bytearray()
            while not answer.endswith(b"\0"):
                answer += os.read(self._read, 1)
            content = json.loads(answer[:-1])
            if content.get("id") == self._number:
                if "error" in content:
                    sys.exit(f"screenshots: {method}: {content['error']['message']}")
                return content["result"]


@contextmanager
def running(command: list[str], environment: dict[str, str], port: int) -> Iterator[None]:
    """A process that listens at ``port``, and its children, until the block ends."""
    process = subprocess.Popen(
        command, env=environment, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        while not listening(port):
            if process.poll() is not None:
                sys.exit(f"screenshots: {command[0]} ended with code {process.returncode}")
            time.sleep(0.1)
        yield
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()


def keep(picture: Path, name: str) -> None:
    """Put a picture among the documents' images."""
    with Image.open(picture) as image:
        image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(IMAGES / name, optimize=True)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


if __name__ == "__main__":
    main()
