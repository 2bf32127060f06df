"""A run folder is read back as it was written; whatever else it holds is refused in one line with file and field."""

import json
import shutil
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.one_run import run_to_folder
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage import manifest, run_folder
from scenarios.storage.run_folder import LAW, RESULT, SCENARIO, TRAJECTORY, read

SHORT = 0.3
"""Seconds: ten states."""


def make(scenario: str, folder: Path, *changes: str, duration: float | None = SHORT) -> Path:
    experiment = open_experiment(scenario, ('plant.name="saturated"', *changes), duration)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("scenarios.one_run._draw_overview", lambda *_: None)  # takes as long as all else
        run_to_folder(experiment, 3, folder, Console(quiet=True), recorded=False)
    return folder


@pytest.fixture(scope="session")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A run of a built-in law and one of an own law."""
    folder = tmp_path_factory.mktemp("runs")
    return {name: make(name, folder / name) for name in ("maneuver", "own-law")}


@pytest.fixture
def run(runs: dict[str, Path], tmp_path: Path) -> Path:
    """A run folder to damage. It has no manifest, so that each check speaks for itself."""
    shutil.copytree(runs["maneuver"], tmp_path / "run")
    (tmp_path / "run" / manifest.NAME).unlink()
    return tmp_path / "run"


def refusal(folder: Path) -> str:
    with pytest.raises(InputError) as raised:
        read(folder)
    message = str(raised.value)
    assert "\n" not in message
    assert len(message) < 500
    return message


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    content = json.loads(path.read_text(encoding="utf-8"))
    change(content)
    path.write_text(json.dumps(content), encoding="utf-8")


def edit_states(path: Path, **changed: Any) -> None:
    with np.load(path) as data:
        states = dict(data)
    states |= {name: change(states[name]) for name, change in changed.items()}
    np.savez(path, **{name: value for name, value in states.items() if value is not None})


@pytest.mark.parametrize("name", ["maneuver", "own-law"])
def test_a_run_is_read_back_bit_for_bit(runs: dict[str, Path], name: str) -> None:
    again = read(runs[name])
    changes = ('plant.name="saturated"',)
    made = simulate(open_experiment(name, changes, SHORT), 3)
    for field in fields(Trajectory):
        assert getattr(again.trajectory, field.name).tobytes() == getattr(made, field.name).tobytes()
    assert again.experiment.file.sha256 == open_experiment(name, changes).file.sha256
    assert (again.result["seed"], again.experiment.asked_duration) == (3, SHORT)


def test_a_run_of_a_scenarios_own_duration_is_read_back_without_one(tmp_path: Path) -> None:
    phases = 'phases=[{name="a", duration_s=0.1}, {name="b", duration_s=0.2}]'
    folder = make("maneuver", tmp_path / "run", phases, "law.first_follower=stationary", duration=None)
    assert read(folder).experiment.asked_duration is None
    assert [phase.duration for phase in read(folder).experiment.phases] == [0.1, 0.2]


def test_a_diverged_run_is_read_back(tmp_path: Path) -> None:
    slow = ('plant.name="single_integrator"', "plant.control_period_s=100")  # far beyond what the integrator stands
    folder = make("shape", tmp_path / "run", *slow, duration=10_000.0)
    assert read(folder).result["outcome"] == "diverged"


@pytest.mark.parametrize("file", [RESULT, SCENARIO])
@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b'{"a":' * 100_000, b"\xff", b"7", b"[]", b"null"])
def test_what_is_not_a_json_object_is_refused_by_its_file(run: Path, file: str, content: bytes) -> None:
    (run / file).write_bytes(content)
    assert refusal(run).startswith(f"{run / file}: ")


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("schema_version", 99, "schema_version: expected 1, got 99; written by a newer version"),
        ("schema_version", 0, "schema_version: expected 1, got 0; make the run again"),
        ("schema_version", None, "schema_version: expected 1, got None; make the run again"),
        ("schema_version", True, "schema_version: expected 1, got True"),
        ("scenario", "../../home", "scenario: expected"),
        ("scenario", "a\x1b[31m", "scenario: expected"),
        ("scenario_sha256", "0" * 64, "(scenario_sha256)"),
        ("scenario_sha256", "short", "scenario_sha256: expected"),
        ("seed", "3", "seed: expected a valid integer, got '3'"),
        ("seed", -1, "seed: expected greater than or equal to 0, got -1"),
        ("seed", 3.5, "seed: expected a valid integer, got 3.5"),
        ("plant", "pymunk", "plant: expected 'saturated' as in scenario.json, got 'pymunk'"),
        ("plant", 1, "plant: expected a valid string, got 1"),
        ("safety", "none", "safety: expected 'decentralised'"),
        ("goal_rad", 0.5, "goal_rad: expected 0.01"),
        ("goal_rad", float("nan"), "goal_rad: expected"),
        (
            "outcome",
            "splendid",
            "outcome: expected 'converged', 'not_converged', 'rejected' or 'diverged', got 'spl",
        ),
        ("planned_duration_s", 0.0, "planned_duration_s: expected greater than 0, got 0.0"),
        ("asked_duration_s", 1e300, "--duration: expected at most"),
        ("asked_duration_s", 600.0, "planned_duration_s: expected 600, got 0.3"),
        ("duration_s", 7.0, "t: expected 7.0 s at the end as in result.json"),
        ("duration_s", [0.3], "duration_s: expected a valid number, got [0.3]"),
        ("angles", [], "angles: expected"),
        ("angles", {}, "angles: expected a valid list"),
        ("versions", {"python": 3}, "versions.python: expected a valid string, got 3"),
        ("min_separation", {}, "min_separation.distance_m: missing"),
        ("testbed", {"accepted": 1, "violations": []}, "testbed.accepted: expected a valid boolean, got 1"),
        ("testbed", {"accepted": True, "violations": [{}]}, "testbed.violations[1].kind: missing"),
    ],
)
def test_a_field_of_the_result_that_is_not_a_runs_is_named(run: Path, field: str, value: object, words: str) -> None:
    edit_json(run / RESULT, lambda content: content.update({field: value}))
    assert words in refusal(run)


def test_every_field_of_the_result_that_is_read_is_missed_by_name(run: Path) -> None:
    content = json.loads((run / RESULT).read_text(encoding="utf-8"))
    unread = {"agents", "asked_duration_s", "contacts", "late_rates_per_s", "interventions", "relaxed", "deadlocks"}
    unread |= {"clearance"}  # folders of before it was measured have none
    for field in content.keys() - unread:
        (run / RESULT).write_text(json.dumps({k: v for k, v in content.items() if k != field}), encoding="utf-8")
        assert refusal(run).startswith(f"{run / RESULT}: {field}: ")


def test_the_scenario_of_another_run_and_an_edited_one_are_refused(run: Path, runs: dict[str, Path]) -> None:
    edit_json(run / SCENARIO, lambda content: content["goal"].update(angle_error_sum_rad=0.5))
    assert f"{run / SCENARIO}: not what result.json says was run" in refusal(run)
    shutil.copy(runs["own-law"] / SCENARIO, run)
    shutil.copy(runs["own-law"] / LAW, run)
    assert f"{run / SCENARIO}: not what result.json says was run" in refusal(run)


def test_an_edited_law_is_refused_and_so_is_one_outside_the_folder(runs: dict[str, Path], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(runs["own-law"], folder)
    with (folder / LAW).open("a", encoding="utf-8") as file:
        file.write("# edited\n")
    assert "not what result.json says was run" in refusal(folder)
    for outside in ("/dev/zero", "../law.py", "sub/law.py"):
        edit_json(folder / SCENARIO, lambda content, outside=outside: content["law"].update(file=outside))
        assert f"law.file: expected 'law.py', in the run folder, got {outside!r}" in refusal(folder)


def test_a_key_that_a_later_version_gives_a_default_does_not_change_the_digest(run: Path) -> None:
    from scenarios.definition.load import digest, validate

    content = json.loads((run / SCENARIO).read_text(encoding="utf-8"))
    del content["obstacles"]  # as if written before scenarios had any
    edit_json(run / RESULT, lambda result: result.update(scenario_sha256=digest(content, None)))
    (run / SCENARIO).write_text(json.dumps(content), encoding="utf-8")
    assert validate(content, "scenario.json").obstacles == ()
    assert read(run).experiment.arena.obstacles == ()


STATES: dict[str, tuple[dict[str, Any], str]] = {
    "strings": ({"poses": lambda a: a.astype("U8")}, "poses: expected float64, got <U"),
    "complex": ({"points": lambda a: a.astype(complex)}, "points: expected float64, got complex128"),
    "single precision": ({"points": lambda a: a.astype(np.float32)}, "points: expected float64, got float32"),
    "objects": ({"t": lambda a: a.astype(object)}, "t: expected float64, got object"),
    "structures": ({"t": lambda a: a.view([("x", "<f8")])}, "t: expected float64, got"),
    "dates": ({"t": lambda a: (a * 1e3).astype("datetime64[ms]")}, "t: expected float64, got datetime64"),
    "numbers for flags": ({"active": lambda a: a.astype(float)}, "active: expected bool, got float64"),
    "nan in time": ({"t": lambda a: np.where(a > 0.1, np.nan, a)}, "t: expected times that begin at 0"),
    "equal times": ({"t": lambda a: np.zeros_like(a)}, "t: expected times that begin at 0 and grow"),
    "times backwards": ({"t": lambda a: a[::-1].copy()}, "t: expected times that begin at 0"),
    "a late start": ({"t": lambda a: a + 1.0}, "t: expected times that begin at 0"),
    "nan in a pose": ({"poses": lambda a: a * np.nan}, "poses: expected finite numbers"),
    "an infinite point": ({"points": lambda a: a + np.inf}, "points: expected finite numbers"),
    "another start": ({"points": lambda a: a + 1e-3}, "points: expected to begin where the scenario and seed 3 say"),
    "a phase beyond": ({"phase": lambda a: a + 9}, "phase: expected integers from 0 to 0"),
    "a phase before": ({"phase": lambda a: a - 1}, "phase: expected integers from 0 to 0"),
    "contact with a stranger": ({"contact": lambda a: a + 100}, "contact: expected integers from -1 to 6"),
    "blocked by a stranger": ({"blockers": lambda a: a + 100}, "blockers: expected integers from -1 to 9"),
    "negative relaxation": ({"relaxation": lambda a: a - 1.0}, "relaxation: expected no negative number"),
    "a short array": ({"stuck": lambda a: a[:-1]}, "stuck: expected the shape (10, 6), got (9, 6)"),
    "one state": ({"t": lambda a: a[:1]}, "t: expected the shape (T,) with T from 2 to 10, got (1,)"),
    "no state": ({"t": lambda a: a[:0]}, "t: expected the shape (T,) with T from 2 to 10, got (0,)"),
    "more states than periods": ({"t": lambda a: np.arange(99.0)}, "t: expected the shape (T,) with T from 2 to 10"),
    "a number for times": ({"t": lambda a: np.float64(0.0)}, "t: expected the shape (T,)"),
    "another number of agents": ({"poses": lambda a: a[:, :3]}, "poses: expected the shape (10, 6, 3), got (10, 3, 3)"),
    "a missing field": ({"blockers": lambda a: None}, "blockers: missing"),
    "no errors": ({"angle_errors": lambda a: None}, "angle_errors: missing"),
}


@pytest.mark.parametrize("damage", STATES)
def test_states_that_are_not_a_runs_are_named_by_their_field(run: Path, damage: str) -> None:
    changed, words = STATES[damage]
    edit_states(run / TRAJECTORY, **changed)
    message = refusal(run)
    assert message.startswith(f"{run / TRAJECTORY}: ")
    assert words in message


@pytest.mark.parametrize("content", [b"", b"PK", b"\x93NUMPY nonsense", b"PK\x05\x06" + bytes(18)])
def test_a_file_that_is_no_archive_of_states_is_refused(run: Path, content: bytes) -> None:
    (run / TRAJECTORY).write_bytes(content)
    assert refusal(run).startswith(f"{run / TRAJECTORY}: ")


def test_a_header_that_promises_more_than_a_run_has_is_refused_before_memory_is_taken(run: Path) -> None:
    import zipfile

    with zipfile.ZipFile(run / TRAJECTORY, "w") as archive, archive.open("t.npy", "w") as member:
        np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": (10**15,)})
    assert "t: expected the shape (T,) with T from 2 to 10, got (1000000000000000,)" in refusal(run)


def test_pipes_devices_and_folders_in_the_place_of_files_are_refused_at_once(run: Path) -> None:
    import os

    for name in (SCENARIO, RESULT, TRAJECTORY):
        kept = (run / name).read_bytes()
        (run / name).unlink()
        os.mkfifo(run / name)
        assert str(run) in refusal(run)
        (run / name).unlink()
        (run / name).symlink_to("/dev/zero")
        assert str(run) in refusal(run)
        (run / name).unlink()
        (run / name).write_bytes(kept)
    assert read(run).result["seed"] == 3


def test_a_sound_file_of_another_run_is_told_by_the_manifest(runs: dict[str, Path], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(runs["maneuver"], folder)
    edit_states(folder / TRAJECTORY, points=lambda a: a + 1e-3 * np.arange(len(a))[:, None, None])
    assert f"{folder / TRAJECTORY}: changed since the run wrote it" in refusal(folder)
    shutil.copy(runs["maneuver"] / TRAJECTORY, folder)
    edit_json(folder / RESULT, lambda content: content.update(outcome="converged"))
    assert f"{folder / RESULT}: changed since the run wrote it" in refusal(folder)


def test_what_is_no_run_folder_is_refused(tmp_path: Path) -> None:
    assert "no such run folder" in refusal(tmp_path / "none")
    assert "not a run folder" in refusal(tmp_path)
    assert run_folder.is_run(tmp_path) is False
