"""What the shell offers behind the begin of a word."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from robots import PLANTS
from robots.safety import FILTERS
from scenarios.cli.main import cli
from scenarios.definition.keys import keys
from scenarios.definition.load import library


def offered(*words: str) -> list[str]:
    """For the last of the words, which may be empty."""
    found = ShellComplete(cli, {}, "formation", "_FORMATION_COMPLETE").get_completions(list(words[:-1]), words[-1])
    return [item.value for item in found]


@pytest.mark.parametrize("command", ["run", "show", "check", "sweep", "export"])
def test_every_command_that_takes_a_scenario_offers_the_library(command: str) -> None:
    assert offered(command, "") == library()


def test_plants_filters_and_keys_are_offered_where_they_may_stand() -> None:
    assert offered("run", "--plant", "") == list(PLANTS)
    assert offered("run", "--safety", "") == list(FILTERS)
    names = {key.name for key in keys()}
    for option in ("--set", "--vary"):
        found = [text.removesuffix("=") for text in offered("sweep", option, "sensor.")]
        assert found
        assert set(found) <= names


@pytest.mark.parametrize("command", ["plot", "animate", "replay", "table"])
def test_finished_runs_are_offered_and_nothing_else(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs" / "killed").mkdir(parents=True)
    (tmp_path / "runs" / "mine").mkdir()
    (tmp_path / "runs" / "mine" / "result.json").touch()
    assert offered(command, "") == ["runs/mine"]


@pytest.mark.parametrize(("command", "more"), [("plot", True), ("table", True), ("animate", False)])
def test_sweeps_are_offered_where_they_may_stand(
    command: str, more: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs" / "sweep").mkdir(parents=True)
    (tmp_path / "runs" / "sweep" / "summary.json").touch()
    assert ("runs/sweep" in offered(command, "")) == more


def test_the_shell_asks_the_command_itself_and_waits_for_no_numpy(tmp_path: Path) -> None:
    code = (
        "import sys, atexit; atexit.register(lambda: print('numpy' in sys.modules)); sys.argv[0] = 'formation'; "
        "from scenarios.cli.main import main; main()"
    )
    asked = {"COMP_WORDS": "formation run sha", "COMP_CWORD": "2", "_FORMATION_COMPLETE": "bash_complete"}
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **asked}, capture_output=True, text=True, cwd=tmp_path
    )
    assert done.stdout.splitlines() == ["plain,shape", "False"]
