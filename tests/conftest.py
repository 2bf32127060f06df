"""What all tests share: hypothesis settings, scenarios made from the library's, and targets for benchmarks."""

import math
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import hypothesis
import numpy as np
import pytest

from formation import SensingGraph, TargetFormation
from robots.worlds import NOTHING
from scenarios.cli import DONE, main
from scenarios.definition.experiment import Experiment, build, open_experiment
from scenarios.definition.load import LIBRARY, ScenarioFile, validate
from scenarios.simulation.compiling import ANNOUNCEMENT
from scenarios.simulation.trajectory import Trajectory

hypothesis.settings.register_profile("project", deadline=None, derandomize=True, max_examples=60)
hypothesis.settings.load_profile("project")

SHELL = ("false", "sh", "true")
"""Programs that every machine has, and that a test or a library may start."""

TOOLS = pytest.StashKey[tempfile.TemporaryDirectory[str]]()
MEASURED = pytest.StashKey[list[tuple[str, str, str, bool]]]()


Seen = TypeVar("Seen")

TIME_ENOUGH = 60.0
"""Seconds of a busy machine after which what has not happened counts as never happening."""

POLL = 0.05
"""Seconds between two looks."""


@pytest.fixture(scope="session")
def shape() -> Experiment:
    """The paper's shape experiment, as the library has it."""
    return open_experiment("shape")


@pytest.fixture(scope="session")
def paper() -> TargetFormation:
    """The paper's shape on the paper's graph."""
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]])
    return TargetFormation(SensingGraph(np.array([[0, 1], [1, 2], [0, 3], [0, 3]])), places)


@pytest.fixture(scope="session")
def strip() -> Callable[[int], TargetFormation]:
    """Makes the equilateral strip of n agents, each sensing the two before it: a cascade as long as can be."""

    def make(n: int) -> TargetFormation:
        places = np.array([[0.5 * k, (k % 2) * np.sqrt(3.0) / 2.0] for k in range(n)])
        return TargetFormation(SensingGraph(np.array([[k - 2, k - 1] for k in range(2, n)])), places)

    return make


@pytest.fixture(scope="session")
def varied() -> Callable[..., Experiment]:
    """Makes the shape experiment with ``--set`` changes, and keys taken away first."""

    def make(*changes: str, duration: float | None = None, without: str | None = None, **tables: Any) -> Experiment:
        if without is None and not tables:
            return open_experiment("shape", changes, duration)
        data = tomllib.loads((LIBRARY / "shape.toml").read_text(encoding="utf-8"))
        if without is not None:
            del data[without]
        return build(ScenarioFile("varied", "varied", "", validate(data | tables, "varied")), duration)

    return make


@pytest.fixture(scope="session")
def moving(varied: Callable[..., Experiment]) -> Callable[[str], Experiment]:
    """Makes a short two-phase maneuver of the six robots with the named first-follower law."""

    def make(first_follower: str, plant: str = "single_integrator") -> Experiment:
        phases = [
            {"name": "up", "duration_s": 2.0, "velocity_m_s": [0.0, 0.02], "displacement_m": [0.4, 0.4]},
            {"name": "right", "duration_s": 2.0, "velocity_m_s": [0.05, 0.01], "displacement_m": [0.4, -0.4]},
        ]
        return varied(
            without="duration_s", phases=phases, law={"first_follower": first_follower}, plant={"name": plant}
        )

    return make


@pytest.fixture
def cli(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Runs the command line in this process, in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("scenarios.terminal.SAID_EVERY", math.inf)  # how often it is said tells how busy a machine is

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["formation", *arguments])
        code = DONE
        try:
            main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else DONE
        out, err = capsys.readouterr()
        # On a fresh machine whichever test compiles first would find the word that test_machine.py tests.
        return code, out, err.removeprefix(f"{ANNOUNCEMENT}\n")

    return run


@pytest.fixture
def eventually() -> Callable[[Callable[[], Seen], Seen], Seen]:
    """Looks at what another process or thread changes until it is as expected, or has had time enough; what it was."""

    def wait(look: Callable[[], Seen], expected: Seen) -> Seen:
        deadline = time.monotonic() + TIME_ENOUGH
        while (seen := look()) != expected and time.monotonic() < deadline:
            time.sleep(POLL)
        return seen

    return wait


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Trajectory]:
    """Makes a trajectory from times (T,), poses (T, n, 3) and points (T, n, 2); all else as if nothing happened."""

    def make(t: np.ndarray, poses: np.ndarray, points: np.ndarray, **states: np.ndarray) -> Trajectory:
        robots = points.shape[:2]
        nothing = {
            "wheel_speeds": np.zeros((*robots, 2)),
            "phase": np.zeros(len(t), dtype=np.intp),
            "contact": np.full(robots, NOTHING),
            "active": np.ones(robots, dtype=bool),
            "intervention": np.zeros(robots),
            "relaxation": np.zeros(robots),
            "blockers": np.full((*robots, 3), -1, dtype=np.int32),
            "stuck": np.zeros(robots),
            "wish": np.zeros((*robots, 2)),
            "command": np.zeros((*robots, 2)),
        }
        return Trajectory(t=t, poses=poses, points=points, **(nothing | states))

    return make


@pytest.fixture
def target(request: pytest.FixtureRequest) -> Callable[[str, float, float, str], None]:
    """Prints a measured figure beside its target when the session ends, and fails where it is missed."""
    rows = request.config.stash.setdefault(MEASURED, [])

    def against(name: str, measured: float, at_most: float, unit: str) -> None:
        met = measured <= at_most
        rows.append((name, f"{measured:.4g} {unit}", f"{at_most:g} {unit}", met))
        assert met, f"{name}: {measured:.4g} {unit}, target {at_most:g} {unit}"

    return against


def pytest_configure(config: pytest.Config) -> None:
    """Leave on the PATH what `make install` brought and the shell: no test leans on a program of this machine.

    Nor on how it was started: a shell lets what it starts in the background ignore the keyboard's interrupt.
    """
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("COLUMNS", None)  # whoever starts it may export the width of a terminal of its own: readline does
    found = {name: shutil.which(name) for name in SHELL}
    tools = config.stash[TOOLS] = tempfile.TemporaryDirectory(prefix="tools-")
    for name, program in found.items():
        if program is not None:
            Path(tools.name, name).symlink_to(os.path.realpath(program))
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), tools.name])


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the folder of links."""
    config.stash[TOOLS].cleanup()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Measured figures beside their targets."""
    rows = config.stash.get(MEASURED, [])
    if rows:
        terminalreporter.section("measured against target")
        width = max(len(name) for name, *_ in rows)
        for name, measured, at_most, met in rows:
            terminalreporter.line(
                f"{name:{width}}  {measured:>12}  at most {at_most:<10}  {'met' if met else 'MISSED'}"
            )


@pytest.fixture(autouse=True)
def _no_global_randomness() -> Iterator[None]:
    """A test that draws from numpy's global state would depend on the order of the tests."""
    before = np.random.get_state()[1].tolist()  # noqa: NPY002 (looks at the global state, draws nothing)
    yield
    assert np.random.get_state()[1].tolist() == before, "numpy's global random state was used"  # noqa: NPY002
