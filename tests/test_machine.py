"""What is promised holds on every machine: no program but ours, no folder that can be written, no terminal."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from robots.compiled import at_hand, compiled
from robots.compiled.functions import ingredients
from robots.safety.step import filter_step
from scenarios.definition.experiment import open_experiment
from scenarios.simulation import compiling

NOWHERE = """
import warnings
from numba.core import caching
caching.CacheImpl._locator_classes = []  # as numba finds them: nothing can be written
warnings.simplefilter("error")
from robots.compiled import at_hand, kept
kept.folders = lambda *source: [__import__("pathlib").Path("/proc/nowhere")]
from robots.safety import solver
from robots.worlds import bodies, chipmunk
import numpy as np
import pymunk
space = pymunk.Space()
space.add(pymunk.Body(1.0, 1.0))
seen, alive = chipmunk.bodies_of(space, space.bodies)
print(at_hand(bodies.move), solver.within_wheels(0.3, 0.0, 0.0, 0.0, 0.2, 2.2))
bodies.move(bodies.Chassis(seen, np.zeros(0), 4, np.zeros((0, 2))), 0.033)
print(seen.state[0].tolist())
"""


def test_the_path_of_the_tests_holds_the_environments_programs_and_the_shells_alone() -> None:
    ours, shells = map(Path, os.environ["PATH"].split(os.pathsep))
    assert ours == Path(sys.executable).parent
    assert sorted(program.name for program in shells.iterdir()) == ["false", "sh", "true"]
    assert shutil.which("ffmpeg") is None


def test_where_no_machine_code_can_be_kept_the_filter_runs_without_a_word() -> None:
    done = subprocess.run([sys.executable, "-c", NOWHERE], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "False 0.0\n[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n", "")


def test_machine_code_is_at_hand_once_a_function_was_called() -> None:
    def twice(x: float) -> float:
        return 2.0 * x

    function = compiled(twice)
    assert function(2.0) == 4.0
    assert at_hand(function)
    assert at_hand(twice)  # not compiled at all
    assert not at_hand(compiled(lambda x: x))


@pytest.mark.parametrize("ready", [True, False])
def test_one_word_announces_what_takes_seconds_and_nothing_else_does(
    ready: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("robots.compiled.at_hand", lambda function: function is filter_step and ready)
    for name in ("none", "centralised", "decentralised"):
        compiling.compile_for(open_experiment("law-distance", (f"safety.filter='{name}'",)))
    assert capsys.readouterr() == ("", "" if ready else "formation: compiling, once\n")


def test_a_folder_of_the_users_that_is_called_robots_does_not_hide_the_package(tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.toml").write_text("", encoding="utf-8")
    script = tmp_path / "script.py"
    script.write_text("from robots import GTERNAL\nimport scenarios.one_run\nprint(GTERNAL.drive.base_length)\n")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, cwd=tmp_path)
    assert (done.stdout, done.stderr) == ("0.11\n", "")


def test_without_a_home_a_run_with_its_figures_says_nothing_on_the_side(tmp_path: Path) -> None:
    nowhere = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "MPL"))}
    command = [sys.executable, "-m", "scenarios", "run", "shape", "--plant", "saturated", "--safety", "none"]
    done = subprocess.run(
        [*command, "--duration", "0.5", "--no-recording", "--out", str(tmp_path / "run")],
        capture_output=True,
        text=True,
        env=nowhere | {"HOME": "/proc/nowhere"},
    )
    assert (done.returncode, done.stderr) == (1, "")
    assert (tmp_path / "run" / "figure-motion.png").is_file()


def test_machine_code_is_made_of_the_constants_that_it_names() -> None:
    """A function is compiled anew where a constant changes that another file keeps."""
    source = compile("def there(x):\n    return LIMIT * x\n", str(Path(__file__)), "exec")
    parts = []
    for limit in (1.0, 1.0, 2.0):
        seen: dict = {"LIMIT": limit}
        exec(source, seen)
        parts.append(ingredients(seen["there"]))
    assert parts[0] == parts[1] != parts[2]
