"""Run folders: written whole or not at all."""

import os
from pathlib import Path

import pytest

from scenarios.errors import InputError
from scenarios.storage import manifest, run_folder
from scenarios.storage.files import write_whole
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
    run_of(folder, "new")
    assert sorted(os.listdir(folder)) == sorted([manifest.NAME, run_folder.RESULT, run_folder.TRAJECTORY])
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


def test_what_no_run_wrote_is_never_replaced(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "run", "old")
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"holds notes\.txt, which no run wrote; move it, or name another folder"):
        run_of(folder, "new")
    assert (folder / "notes.txt").read_text(encoding="utf-8") == "mine"
    assert (folder / run_folder.RESULT).read_text(encoding="utf-8") == "old"
    assert os.listdir(tmp_path) == ["run"]


def test_what_looks_like_a_run_but_was_not_written_by_one_is_left_alone(tmp_path: Path) -> None:
    folder = tmp_path / "holiday"
    (folder / "photos").mkdir(parents=True)
    fill(folder, "")
    with pytest.raises(InputError, match="exists and is not a run folder"):
        run_of(folder)
    assert sorted(os.listdir(folder)) == ["photos", run_folder.RESULT, run_folder.TRAJECTORY]


def test_a_file_of_a_run_that_was_edited_is_the_users(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "run")
    (folder / run_folder.RESULT).write_text("edited", encoding="utf-8")
    with pytest.raises(InputError, match=r"holds result\.json, which was changed since it was written"):
        run_of(folder)
    assert (folder / run_folder.RESULT).read_text(encoding="utf-8") == "edited"


def test_a_link_in_a_run_folder_is_the_users(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "run")
    (tmp_path / "elsewhere").mkdir()
    (folder / "more").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="holds more, which no run wrote"):
        run_of(folder)


def test_a_figure_that_was_drawn_into_a_run_goes_with_it(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "run")
    write_whole(folder / "figure-graph.png", b"drawn")
    write_whole(folder / "figure-graph.png", b"drawn again")
    assert manifest.foreign(folder) is None
    run_of(folder, "new")
    assert sorted(os.listdir(folder)) == sorted([manifest.NAME, run_folder.RESULT, run_folder.TRAJECTORY])


def appears(place: Path) -> None:
    place.mkdir()
    (place / "thesis.tex").write_text("mine", encoding="utf-8")


def is_noted(place: Path) -> None:
    (place / "notes.txt").write_text("mine", encoding="utf-8")


@pytest.mark.parametrize("older", [False, True])
def test_a_run_whose_place_is_taken_while_it_is_under_way_is_kept_beside_it(tmp_path: Path, older: bool) -> None:
    place = tmp_path / "run"
    if older:
        run_of(place, "old")
    (tmp_path / "run-2").mkdir()
    (tmp_path / "run-2" / "other").touch()

    def run() -> None:
        with writing(place) as new:
            fill(new, "new")
            (is_noted if older else appears)(place)

    with pytest.raises(InputError, match=r"and was left alone; the run is kept in .*/run-3$"):
        run()
    assert (place / ("notes.txt" if older else "thesis.tex")).read_text(encoding="utf-8") == "mine"
    assert not older or (place / run_folder.RESULT).read_text(encoding="utf-8") == "old"
    assert (tmp_path / "run-3" / run_folder.RESULT).read_text(encoding="utf-8") == "new"
    assert sorted(os.listdir(tmp_path)) == ["run", "run-2", "run-3"]
    run_of(tmp_path / "run-3", "newer")  # a run folder like any other


def test_two_runs_into_one_place_at_once_are_one_run_and_one_line(tmp_path: Path) -> None:
    with writing(tmp_path / "run") as new:
        fill(new, "first")
        with pytest.raises(InputError, match="another process is writing it"):
            run_of(tmp_path / "run", "second")
    assert (tmp_path / "run" / run_folder.RESULT).read_text(encoding="utf-8") == "first"
    assert os.listdir(tmp_path) == ["run"]


def test_a_run_that_is_not_finished_is_no_run(tmp_path: Path) -> None:
    with writing(tmp_path / "run") as new:
        fill(new)
        assert not is_run(new)
        with pytest.raises(InputError, match="not a finished run"):
            run_folder.read(new)
