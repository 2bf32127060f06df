"""A run is made again bit for bit from its folder, and another begins where it ended."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.storage.run_folder import LAW, RESULT, SCENARIO, read

Cli = Callable[..., tuple[int, str, str]]

QUICK = ("--no-recording", "--duration", "0.7")


@pytest.fixture(autouse=True)
def _undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The figure of a run says nothing here, and takes as long as all else."""
    monkeypatch.setattr("scenarios.one_run._draw_overview", lambda *_: None)


def same(one: Path, other: Path) -> bool:
    """Whether two runs have the same bits in every state, and the same results."""
    results = [json.loads((folder / RESULT).read_text(encoding="utf-8")) for folder in (one, other)]
    with np.load(one / "trajectory.npz") as a, np.load(other / "trajectory.npz") as b:
        return results[0] == results[1] and all(a[key].tobytes() == b[key].tobytes() for key in a)


@pytest.mark.parametrize("source", ["first", "first/scenario.json"])
@pytest.mark.parametrize(
    "options",
    [
        ("shape", "--seed", "5"),
        ("maneuver", "--plant", "unicycle", "--safety", "centralised", "--set", "sensor.position_noise_m=0.01"),
        ("random-50", "--seed", "2", "--plant", "saturated", "--set", "random_formation.agents=7"),
    ],
)
def test_a_run_folder_is_run_again_bit_for_bit(cli: Cli, tmp_path: Path, options: tuple[str, ...], source: str) -> None:
    cli("run", *options, *QUICK, "--out", "first")
    code, out, err = cli("run", source, "--no-recording", "--out", "second")
    assert (code in (0, 1), err) == (True, "")
    assert f"again: {source}, seed {options[2] if options[1] == '--seed' else 0}, nothing changed" in out
    assert same(tmp_path / "first", tmp_path / "second")


def test_a_run_of_its_scenarios_own_length_is_again_of_that_length(cli: Cli, tmp_path: Path) -> None:
    phases = 'phases=[{name="a", duration_s=0.1}, {name="b", duration_s=0.2}, {name="c", duration_s=0.3}]'
    changes = ("--set", phases, "--set", "law.first_follower=stationary", "--plant", "saturated")
    cli("run", "maneuver", *changes, "--no-recording", "--out", "first")
    cli("run", "first", "--no-recording", "--out", "second")
    assert same(tmp_path / "first", tmp_path / "second")


def test_an_own_law_is_run_as_it_was_however_its_file_has_changed(cli: Cli, tmp_path: Path) -> None:
    shutil.copy(LIBRARY / "own-law.toml", tmp_path / "mine.toml")
    shutil.copy(LIBRARY / "bounded_angle_law.py", tmp_path)
    cli("run", "./mine.toml", *QUICK, "--out", "first")
    (tmp_path / "bounded_angle_law.py").write_text("raise RuntimeError", encoding="utf-8")
    code, _, err = cli("run", "./first", "--no-recording", "--out", "second")
    assert (code, err) == (1, "")
    assert same(tmp_path / "first", tmp_path / "second")
    assert (tmp_path / "second" / LAW).read_bytes() == (LIBRARY / "bounded_angle_law.py").read_bytes()


def test_a_run_may_take_its_own_place_again(cli: Cli, tmp_path: Path) -> None:
    cli("run", "shape", *QUICK, "--out", "first")
    shutil.copytree(tmp_path / "first", tmp_path / "before")
    cli("run", "first", "--no-recording", "--out", "first")
    assert same(tmp_path / "first", tmp_path / "before")


def test_options_change_a_run_that_is_made_again_and_are_told(cli: Cli, tmp_path: Path) -> None:
    cli("run", "shape", *QUICK, "--seed", "5", "--out", "first")
    options = ("--seed", "6", "--plant", "unicycle", "--duration", "0.5", "--no-recording")
    _, out, _ = cli("run", "first", *options, "--out", "second")
    assert 'again: first, but with seed 6 in place of 5, plant.name="unicycle", 0.5 s\n' in out
    result = read(tmp_path / "second").result
    assert (result["scenario"], result["seed"], result["plant"], result["duration_s"]) == ("shape", 6, "unicycle", 0.5)


@pytest.mark.parametrize("scenario", ["shape", "random-50", "maneuver"])
def test_a_run_begins_where_another_one_ended(cli: Cli, tmp_path: Path, scenario: str) -> None:
    short = (*QUICK, "--plant", "saturated")
    few = ("--set", "random_formation.agents=6") if scenario == "random-50" else ()
    cli("run", "shape", *short, "--out", "first")
    code, _, err = cli("run", scenario, *short, *few, "--start-from", "first", "--out", "second")
    assert (code in (0, 1), err) == (True, "")
    first, second = read(tmp_path / "first"), read(tmp_path / "second")
    assert np.abs(second.trajectory.points[0] - first.trajectory.points[-1]).max() < 1e-15
    turn = second.trajectory.poses[0, :, 2] - first.trajectory.poses[-1, :, 2]
    assert np.abs(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi).max() < 1e-14
    plain = open_experiment(scenario, tuple(few[1:]))
    assert np.array_equal(second.experiment.target.positions, plain.target.positions)
    assert np.array_equal(second.experiment.graph.edges, plain.graph.edges)
    cli("run", "second", "--no-recording", "--out", "third")
    assert same(tmp_path / "second", tmp_path / "third")


def test_what_cannot_be_run_again_or_begun_from_is_one_line(cli: Cli, tmp_path: Path) -> None:
    cli("run", "shape", *QUICK, "--out", "first")
    cli("run", "shape", *QUICK, "--set", "robot.projection_distance_m=1e-6", "--plant", "unicycle", "--out", "other")
    (tmp_path / "empty").mkdir()
    for arguments, words in {
        ("empty",): "empty: neither a scenario nor a run folder, it holds no result.json",
        ("./none/scenario.json",): "./none/scenario.json: neither a scenario nor a run folder",
        ("first", "--set", "plnt.name=x"): "first/scenario.json: plnt: unknown key, did you mean 'plant'?",
        ("first", "--set", "law.name=own"): "law.file: missing",
        ("random-50", "--start-from", "first"): "--start-from first: that run has 6 agents, expected 50 as random-50",
        ("shape", "--start-from", "empty"): "empty: not a run folder",
        ("shape", "--start-from", "none"): "none: no such run folder",
    }.items():
        code, out, err = cli("run", *arguments, "--out", "x")
        assert (code, out, err.count("\n")) == (2, "", 1), err
        assert words in err
    edited = (tmp_path / "first" / SCENARIO).read_text(encoding="utf-8").replace('"walls": false', '"walls": true')
    (tmp_path / "first" / SCENARIO).write_text(edited, encoding="utf-8")
    assert "not what result.json says was run" in cli("run", "first")[2]
    assert not (tmp_path / "x").exists()
