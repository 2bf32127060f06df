"""Run folders: written whole or not at all."""

import os
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from scenarios.errors import InputError
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage import run_folder
from scenarios.storage.run_folder import is_run, writing


def fill(folder: Path, text: str = "{}") -> None:
    (folder / run_folder.RESULT).write_text(text, encoding="utf-8")
    (folder / run_folder.TRAJECTORY).write_text("", encoding="utf-8")


def run_of(folder: Path, text: str = "{}") -> Path:
    with writing(folder) as scratch:
        fill(scratch, text)
    return folder


def test_a_finished_run_stands_in_its_folder_and_nothing_beside_it(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "deep" / "run")
    assert is_run(folder)
    assert os.listdir(folder.parent) == ["run"]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_an_interrupted_run_leaves_nothing(tmp_path: Path, error: type[BaseException]) -> None:
    def interrupted() -> None:
        with writing(tmp_path / "run") as scratch:
            fill(scratch)
            raise error

    with pytest.raises(error):
        interrupted()
    assert os.listdir(tmp_path) == []


def test_nothing_stands_in_the_place_while_a_run_is_under_way(tmp_path: Path) -> None:
    with writing(tmp_path / "run") as scratch:
        fill(scratch)
        assert not (tmp_path / "run").exists()


def test_an_older_run_is_replaced_by_a_finished_one_and_survives_an_interrupted_one(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "run", "old")

    def interrupted() -> None:
        with writing(folder) as scratch:
            fill(scratch, "broken")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        interrupted()
    assert (folder / run_folder.RESULT).read_text(encoding="utf-8") == "old"
    (folder / "figure.png").touch()
    run_of(folder, "new")
    assert sorted(os.listdir(folder)) == sorted([run_folder.RESULT, run_folder.TRAJECTORY])
    assert (folder / run_folder.RESULT).read_text(encoding="utf-8") == "new"
    assert os.listdir(tmp_path) == ["run"]


def test_a_run_whose_place_cannot_be_taken_leaves_the_older_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = run_of(tmp_path / "run", "old")
    replace = os.replace

    def fails_for_the_new(source: Path, place: Path) -> None:
        if Path(source).name == "new":
            raise OSError(28, "No space left on device")
        replace(source, place)

    monkeypatch.setattr(os, "replace", fails_for_the_new)
    with pytest.raises(InputError, match="cannot be written: No space left on device"):
        run_of(folder, "new")
    assert (folder / run_folder.RESULT).read_text(encoding="utf-8") == "old"
    assert os.listdir(tmp_path) == ["run"]


def test_whatever_is_not_a_run_is_left_alone(tmp_path: Path) -> None:
    folder, file = tmp_path / "mine", tmp_path / "file"
    folder.mkdir()
    (folder / "thesis.tex").write_text("x", encoding="utf-8")
    file.write_text("x", encoding="utf-8")
    for place in (folder, file):
        with pytest.raises(InputError, match="exists and is not a run folder"):
            run_of(place)
    assert (folder / "thesis.tex").read_text(encoding="utf-8") == "x"
    assert sorted(os.listdir(tmp_path)) == ["file", "mine"]


def test_an_empty_folder_and_a_link_to_a_run_are_places_for_a_run(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert is_run(run_of(tmp_path / "empty"))
    (tmp_path / "link").symlink_to("empty")
    run_of(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "empty" / run_folder.RESULT).read_text(encoding="utf-8") == "new"


@pytest.mark.parametrize("place", ["file/run", "loop/run", "a" * 300, "/proc/no/run"])
def test_a_place_that_cannot_be_written_is_refused_before_the_run(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    entered = False

    def run() -> None:
        nonlocal entered
        with writing(tmp_path / place):
            entered = True

    with pytest.raises(InputError, match="cannot be written"):
        run()
    assert not entered


def test_a_trajectory_read_again_is_bit_identical(tmp_path: Path, recorded: Callable[..., Trajectory]) -> None:
    rng = np.random.default_rng(0)
    poses, points = rng.normal(size=(5, 3, 3)), rng.normal(size=(5, 3, 2))
    run = recorded(rng.normal(size=5), poses, points, wheel_speeds=np.full((5, 3, 2), np.nan), phase=np.arange(5))
    run.save(tmp_path / "trajectory.npz", rng.normal(size=(5, 4)))
    again = Trajectory.read(tmp_path / "trajectory.npz")
    for field in fields(Trajectory):
        assert getattr(again, field.name).tobytes() == getattr(run, field.name).tobytes()


@pytest.mark.parametrize("content", [b"", b"PK", b"\x93NUMPY nonsense"])
def test_a_damaged_trajectory_is_bad_input(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "trajectory.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match="cannot be read"):
        Trajectory.read(path)
    with pytest.raises(InputError, match="cannot be read"):
        Trajectory.read(tmp_path / "none.npz")
