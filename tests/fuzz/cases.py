"""The cases: each is a kind and a number, made from them alone, and run in an empty folder."""

from __future__ import annotations

import atexit
import json
import os
import random
import shlex
import shutil
import tempfile
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.definition.load import LIBRARY, library
from tests.fuzz.drive import command, complaint, leftovers, quick
from tests.fuzz.mutate import NUMBERS, STRINGS, any_value, damaged_text, mutated, toml

SHORT = ("--duration", "0.1")
RUNS = {
    "shape": ("shape",),
    "maneuver": ("maneuver", "--plant", "saturated"),
    "random": ("random-50", "--set", "random_formation.agents=6", "--plant", "single_integrator"),
    "own": ("own-law", "--plant", "unicycle"),
}
"""Runs that are damaged."""


@cache
def library_data() -> dict[str, dict[str, Any]]:
    """The parsed scenarios of the library."""
    return {name: tomllib.loads((LIBRARY / f"{name}.toml").read_text(encoding="utf-8")) for name in library()}


def scenario_case(rng: random.Random, folder: Path) -> tuple[list[str], str | None]:
    """A mutant of a scenario file, through one of the commands that take one."""
    name = rng.choice(library())
    if rng.random() < 0.1:
        content = damaged_text((LIBRARY / f"{name}.toml").read_bytes(), rng)
    else:
        content = toml(mutated(library_data()[name], rng)).encode("utf-8", "surrogatepass")
    (folder / "mine.toml").write_bytes(content)
    shutil.copy(LIBRARY / "bounded_angle_law.py", folder)
    plants = rng.choice(((), (), ("--plant", rng.choice(("single_integrator", "unicycle", "saturated", "pymunk")))))
    run = ["run", "./mine.toml", *SHORT, "--no-recording", *plants, "--seed", str(rng.randrange(3))]
    arguments = rng.choices(
        (["show", "./mine.toml"], run, ["export", "./mine.toml"], ["audit", "./mine.toml", "--starts", "0"]),
        (45, 45, 8, 2),
    )[0]
    return arguments, complaint(command(*arguments), "mine.toml", "--", "bounded_angle_law.py")


@cache
def sound_runs() -> Path:
    """A folder with the runs that are damaged, made once a process."""
    folder = Path(tempfile.mkdtemp(prefix="formation-fuzz-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name, arguments in RUNS.items():
        answer = command("run", *arguments, "--duration", "0.3", "--no-recording", "--out", str(folder / name))
        if answer.raised or answer.err:
            raise RuntimeError(answer)
    return folder


def run_folder_case(rng: random.Random, folder: Path) -> tuple[list[str], str | None]:
    """A damaged run folder, through one of the commands that read one."""
    name = rng.choice(list(RUNS))
    run = folder / "damaged"
    shutil.copytree(sound_runs() / name, run)
    if rng.random() < 0.7:
        (run / "manifest.sha256").unlink()  # so that not the digests alone speak
    for _ in range(rng.choice((1, 1, 1, 2))):
        rng.choice((_damage_json, _damage_json, _damage_states, _damage_states, _damage_bytes, _exchange))(run, rng)
    (run / "notes.txt").write_text("mine", encoding="utf-8")
    arguments = rng.choice(
        (
            ["plot", "damaged", "--out", "figures", "--format", "svg"],
            ["animate", "damaged", "--out", "film", "--speed", "1000"],
            ["replay", "damaged"],
            ["replay", "damaged", "damaged"],
            ["run", "damaged", "--no-recording", "--out", "again"],
            ["run", "damaged/scenario.json", *SHORT, "--no-recording", "--out", "again"],
            ["run", "shape", *SHORT, "--no-recording", "--start-from", "damaged", "--out", "next"],
            ["run", "shape", *SHORT, "--no-recording", "--out", "damaged"],
        )
    )
    wrong = complaint(command(*arguments), "damaged", "--")
    if wrong is None and (run / "notes.txt").read_text(encoding="utf-8") != "mine":
        wrong = "notes are lost"
    return arguments, wrong


def _damage_json(run: Path, rng: random.Random) -> None:
    path = run / rng.choice(("result.json", "scenario.json"))
    if not path.is_file() or path.is_symlink():
        return
    try:
        content = json.loads(path.read_bytes())
    except (ValueError, RecursionError):
        return
    if isinstance(content, dict):
        text = json.dumps(mutated(content, rng))
        path.write_text(text, encoding="utf-8", errors="replace")


def _damage_states(run: Path, rng: random.Random) -> None:
    path = run / "trajectory.npz"
    if not path.is_file():  # an earlier damage put a pipe there
        return
    try:
        with np.load(path) as data:
            states = dict(data)
    except Exception:
        return
    key = rng.choice(list(states))
    array = states[key]
    with np.errstate(all="ignore"):
        match rng.randrange(9):
            case 0:
                del states[key]
            case 1:
                states[key] = array[: rng.randrange(len(array))] if array.ndim else array
            case 2:
                states[key] = array.astype(
                    rng.choice(("U4", "S3", "c16", "f4", "f8", "i8", "bool", "u1", "M8[s]", "i2"))
                )
            case 3:
                states[key] = np.where(
                    np.random.default_rng(rng.randrange(99)).random(array.shape) < 0.2, np.nan, array
                )
            case 4:
                states[key] = array * 0
            case 5:
                states[key] = array - rng.choice((1, 100, 10**6)) * np.ones(
                    1, dtype=array.dtype if array.dtype != bool else int
                )
            case 6:
                states[key] = array[..., None] if rng.random() < 0.5 else array.ravel()
            case 7:
                states = {name: value[: max(1, len(value) // 2)] for name, value in states.items()}
            case 8:
                states[key] = np.array(rng.choice((0, "x", 1.5, [], [[1]])))
    np.savez(path, **states)


def _damage_bytes(run: Path, rng: random.Random) -> None:
    path = rng.choice(sorted(run.iterdir()))
    if path.is_file() and not path.is_symlink():
        path.write_bytes(damaged_text(path.read_bytes(), rng))


def _exchange(run: Path, rng: random.Random) -> None:
    """A file gone, or something else in its place."""
    path = rng.choice(sorted(run.iterdir()))
    if path.is_dir():
        return
    path.unlink()
    match rng.randrange(7):
        case 0:
            path.mkdir()
        case 1:
            os.mkfifo(path)
        case 2:
            path.symlink_to(rng.choice(("/dev/zero", "nowhere", ".", path.name)))
        case 3:
            path.touch()
        case 4:
            path.write_bytes(b"[" * 100_000)
        case 5:
            other = sound_runs() / rng.choice(list(RUNS)) / path.name
            if other.is_file():
                shutil.copy(other, path)


OPTIONS: dict[str, tuple[list[str], tuple[str, ...]]] = {
    "list": ([], ()),
    "show": (["shape"], ("--seed", "--set")),
    "run": (
        ["shape", "--no-recording", *SHORT],
        ("--seed", "--plant", "--safety", "--duration", "--set", "--out", "--speed", "--start-from", "--live"),
    ),
    "replay": (["sound"], ("--web",)),
    "plot": (["sound", "--format", "svg"], ("--out", "--format")),
    "animate": (["sound", "--speed", "1000"], ("--format", "--speed", "--fps", "--out")),
    "laws": (["--starts", "1", "--law", "distance"], ("--starts", "--law", "--markdown")),
    "audit": (["shape", "--starts", "0"], ("--starts", "--set", "--markdown")),
    "keys": ([], ("--markdown",)),
    "check": (
        ["nothing", "--workers", "1"],
        ("--baselines", "--junit", "--markdown", "--out", "--workers", "--portable"),
    ),
    "sweep": (
        ["shape", "--seeds", "0:2", "--workers", "1", "--plant", "unicycle", "--set", "duration_s=0.1"],
        ("--seeds", "--plant", "--set", "--vary", "--workers", "--out"),
    ),
    "reproduce": (["--workers", "0"], ("--markdown",)),
    "export": (["maneuver-testbed"], ("--seed", "--safety", "--duration", "--set", "--out", "--force")),
}
"""Arguments that are quick, and options, of every command."""

FLAGS = ("--web", "--live", "--force", "--portable")

PATHS = (
    "new",
    "new/deep",
    "sound",
    "full",
    "file",
    "link",
    "/dev/null",
    "/proc/no",
    "",
    ".",
    "-x",
    "a" * 300,
    "loop",
    "/dev/full",
)
SETTINGS = (
    "plant.name=",
    "duration_s=",
    "safety.filter=",
    "agents.3.start=",
    "agents=",
    "law.name=",
    "title=",
    "sensor.delay_periods=",
)


def option_case(rng: random.Random, folder: Path) -> tuple[list[str], str | None]:
    """A command with mutated options, among places of all sorts."""
    shutil.copytree(sound_runs() / "shape", folder / "sound")
    (folder / "full").mkdir()
    (folder / "full" / "thesis.tex").touch()
    (folder / "file").write_text("mine", encoding="utf-8")
    (folder / "link").symlink_to("file")
    (folder / "loop").symlink_to("loop")
    name = rng.choice(list(OPTIONS))
    fixed, options = OPTIONS[name]
    arguments = [name, *fixed]
    for option in rng.sample(options, rng.randint(0, min(3, len(options)))):
        arguments += [option] if option in FLAGS else [option, _option_value(option, rng)]
    if rng.random() < 0.1:
        del arguments[rng.randrange(1, len(arguments) + 1) :]
    if rng.random() < 0.1:
        arguments.insert(rng.randrange(len(arguments) + 1), rng.choice(STRINGS[:12]))
    if arguments[0] == "reproduce":
        arguments += ["--workers", "0"]  # it takes minutes
    if arguments[0] == "laws" and "--starts" not in arguments:
        arguments += ["--starts", "1"]
    answer = command(*arguments)
    wrong = complaint(answer, *arguments, "--", "argument", "command")
    if wrong is None and (folder / "full" / "thesis.tex").exists() is False:
        wrong = "a file of the user's is lost"
    return arguments, wrong


def _option_value(option: str, rng: random.Random) -> str:
    if option in ("--out", "--markdown", "--junit", "--baselines", "--start-from"):
        return rng.choice(PATHS)
    if option in ("--set", "--vary"):
        return rng.choice(SETTINGS) + str(any_value(rng))[:2000]
    if option == "--seeds":
        return rng.choice(("0:1", "1:0", "0:0", ":", "a:b", "-1:2", "0:2:1", "9" * 30 + ":" + "9" * 31, "0x1:2", "1,2"))
    if option == "--workers":
        return rng.choice(("0", "-1", "1", "x", "nan"))
    if option == "--starts":
        return rng.choice(("0", "1", "-1", "x", "9" * 20, "1.5"))
    if option == "--duration":
        return rng.choice(("0", "-1", "nan", "inf", "1e300", "1e-300", "0.01", "x"))
    if option == "--format":
        return rng.choice(("png", "pdf", "svg", "gif", "mp4", "exe", ""))
    return str(rng.choice((*NUMBERS[:-4], *STRINGS)))[:2000].replace("\0", "")


KINDS: dict[str, Callable[[random.Random, Path], tuple[list[str], str | None]]] = {
    "scenario": scenario_case,
    "run": run_folder_case,
    "option": option_case,
}


def try_case(kind: str, number: int, folder: Path) -> tuple[list[str], str | None]:
    """Run a case in an empty folder; its arguments, and what is wrong."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        arguments, wrong = KINDS[kind](random.Random(f"{kind} {number}"), folder)
        if wrong is None and (left := leftovers(folder)):
            wrong = f"scratch is left: {left}"
    finally:
        os.chdir(before)
    return arguments, wrong


def findings(task: tuple[str, int, int]) -> list[str]:
    """What is wrong among the cases of a kind with the numbers from ``first`` to ``end`` - 1."""
    kind, first, end = task
    found = []
    with quick():
        for number in range(first, end):
            with tempfile.TemporaryDirectory(prefix="formation-fuzz-") as folder:
                arguments, wrong = try_case(kind, number, Path(folder))
            if wrong is not None:
                found.append(f"{kind} {number}: formation {shlex.join(arguments)[:300]}\n{wrong}")
    return found
