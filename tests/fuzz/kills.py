"""``make kills``: commands killed at random moments.

Nothing half-written looks whole, nothing that stood there is lost, after the next command nothing is left over.
"""

from __future__ import annotations

import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scenarios.errors import InputError
from scenarios.simulation.compiling import ANNOUNCEMENT
from scenarios.storage import manifest, run_folder

KILLS = 60
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
ORDERLY = {signal.SIGTERM: 143, signal.SIGINT: 130}

SCENARIO = """
title = "Three"
duration_s = 1.0
agents = [
    { id = 1, start = [0.0, 0.5] },
    { id = 2, neighbours = [1], start = [-0.5, 0.0] },
    { id = 3, neighbours = [1, 2], start = [0.3, 0.2] },
]
target.angles_deg = { "3;2,1" = 90.0, "1;3,2" = 45.0 }
"""

COMMANDS = {
    "run": ("run", "shape", "--duration", "2", "--out", "place/run"),
    "sweep": ("sweep", "./three.toml", "--seeds", "0:20", "--workers", "2", "--out", "place/sweep"),
    "update": ("check", "./three.toml", "--update", "--baselines", "place/baselines", "--workers", "2"),
    "animate": ("animate", "place/run", "--speed", "2", "--fps", "10"),
    "plot": ("plot", "place/run"),
}
NEXT = {
    "run": ("keys", "--markdown", "place/keys.md"),
    "sweep": COMMANDS["sweep"],  # goes on: its scratch is beside its folder and in it
    "update": ("keys", "--markdown", "place/baselines/keys.md"),
    "animate": ("keys", "--markdown", "place/run/keys.md"),
    "plot": ("keys", "--markdown", "place/run/keys.md"),
}
"""What writes into the same folder afterwards."""


@dataclass(frozen=True)
class Ended:
    """How a killed command ended."""

    code: int
    err: str


def start(arguments: Sequence[str], folder: Path) -> subprocess.Popen[str]:
    """The command in a process group of its own, which listens to interrupts."""
    return subprocess.Popen(
        [sys.executable, "-m", "scenarios", *arguments],
        cwd=folder,
        text=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        process_group=0,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def complained(err: str) -> str:
    """What a command says on stderr but for how far it is, which tells how busy a machine is."""
    return "\n".join(line for line in err.splitlines() if line != ANNOUNCEMENT and not line.endswith(" s left"))


def whole(arguments: Sequence[str], folder: Path) -> float:
    """Run a command to its end; the seconds that it takes.

    Raises:
        RuntimeError: it ends badly.
    """
    begin = time.monotonic()
    process = start(arguments, folder)
    err = complained(process.communicate()[1])
    if process.returncode not in (0, 1) or err:
        raise RuntimeError(f"{arguments}: {process.returncode}: {err}")
    return time.monotonic() - begin


def killed(arguments: Sequence[str], folder: Path, number: signal.Signals, after: float) -> Ended:
    """Run a command and send it a signal; an interrupt goes to the whole group, as from a terminal."""
    process = start(arguments, folder)
    try:
        err = process.communicate(timeout=after)[1]
    except subprocess.TimeoutExpired:
        if number == signal.SIGINT:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        err = process.communicate()[1]
    return Ended(process.returncode, err)


def digests(folder: Path) -> dict[str, str]:
    """Of every file that is not hidden."""
    files = [path for path in folder.rglob("*") if path.is_file() and ".unfinished" not in str(path)]
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def complaints(
    name: str, number: signal.Signals, ended: Ended, place: Path, before: dict[str, str], new: set[str]
) -> list[str]:
    """What is wrong after a kill, before any other command; ``new`` are the names of the files of a run just made."""
    found = []
    early = ended.code == -number  # while the interpreter starts or ends, which a shell counts as the same code
    if number in ORDERLY and not early and ended.code not in (0, 1, ORDERLY[number]):
        found.append(f"exit code {ended.code}: {ended.err[-300:]}")
    if "scenarios/" in ended.err and "Traceback" in ended.err:
        found.append(f"a traceback: {ended.err[-600:]}")
    if number in ORDERLY and not early and (left := list(place.rglob(".*.unfinished"))):
        found.append(f"scratch after {number.name}: {left}")
    after = digests(place)
    done = ended.code in (0, 1) or (names(place / "run") == new and manifest.foreign(place / "run") is None)
    replaced = "run/" if name == "run" and done else None  # before it was killed
    for path, digest in before.items():
        if replaced is not None and path.startswith(replaced):
            continue
        if path not in after:
            found.append(f"{path} is gone")
        elif "mine" in path and after[path] != digest:
            found.append(f"{path} of the user's has changed")
        elif name == "run" and path.startswith("run/") and after[path] != digest:
            found.append(f"{path} of the older run has changed")
    for scratch in place.rglob("result.json"):
        try:
            run_folder.read(scratch.parent)
        except InputError as error:
            if ".unfinished" not in str(scratch):
                found.append(f"a run folder that is not whole: {error}")
        else:
            if ".unfinished" in str(scratch):
                found.append(f"{scratch.parent} can be read as if whole")
    return found


def names(folder: Path) -> set[str]:
    """Of the files of a folder."""
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def processes_in(folder: Path) -> list[str]:
    """Processes that still work there."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if Path(os.readlink(entry / "cwd")) == folder:
                found.append((entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()[:100])
        except OSError:
            continue
    return found


def main(kills: int = KILLS) -> int:
    """Kill, look, go on, look again; 1 where anything is wrong."""
    rng, total = random.Random(0), 0
    with tempfile.TemporaryDirectory(prefix="formation-kills-") as name:
        origin = Path(name).resolve() / "origin"
        place = origin / "place"
        place.mkdir(parents=True)
        (origin / "three.toml").write_text(SCENARIO, encoding="utf-8")
        whole(COMMANDS["run"], origin)  # compiles, where nothing did before: later ones are over sooner
        new = names(place / "run")
        seconds = {command: whole(arguments, origin) for command, arguments in COMMANDS.items()}
        shutil.rmtree(place / "sweep")  # of a sweep that is done nothing would be left to do
        (place / "sweep").mkdir()
        (place / "mine.txt").write_text("mine", encoding="utf-8")
        (place / "baselines" / "mine.txt").write_text("mine", encoding="utf-8")
        print("seconds undisturbed: " + ", ".join(f"{key} {value:.1f}" for key, value in seconds.items()), flush=True)
        for kill in range(kills):
            command = list(COMMANDS)[kill % len(COMMANDS)]
            number = SIGNALS[kill // len(COMMANDS) % len(SIGNALS)]
            after = rng.uniform(0.0, 1.05 * seconds[command])
            folder = Path(name).resolve() / f"kill{kill}"
            shutil.copytree(origin, folder)
            before = digests(folder / "place")
            ended = killed(COMMANDS[command], folder, number, after)
            found = complaints(command, number, ended, folder / "place", before, new)
            deadline = time.monotonic() + 30.0
            while (alive := processes_in(folder)) and time.monotonic() < deadline:
                time.sleep(0.1)
            found += [f"a process is left: {process}" for process in alive]
            whole(NEXT[command], folder)
            found += [f"scratch is left: {path}" for path in (folder / "place").rglob(".*.unfinished")]
            print(
                f"{kill}: {command}, {number.name} after {after:.2f} s: code {ended.code}",
                *found,
                sep="\n  ",
                flush=True,
            )
            total += len(found)
            shutil.rmtree(folder)
    print(f"{kills} kills, {total} findings")
    return min(total, 1)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
