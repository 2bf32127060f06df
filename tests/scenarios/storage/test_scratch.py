"""What is under way leaves nothing behind, whether it ends, is interrupted or is killed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.errors import InputError
from scenarios.storage import scratch

KILLED = """
import os, signal, sys
from pathlib import Path
from scenarios.storage import scratch
place = Path(sys.argv[1])
with scratch.beside(place, exclusive=sys.argv[2] == "exclusive") as room:
    (room / "new").mkdir()
    (room / "new" / "result.json").write_text("{}")
    if place.exists():
        (room / scratch.ASIDE).mkdir()
        os.replace(place, room / scratch.ASIDE / place.name)
    os.kill(os.getpid(), signal.SIGKILL)
"""


def kill_one_that_writes(place: Path, kind: str) -> None:
    done = subprocess.run([sys.executable, "-c", KILLED, str(place), kind], check=False)
    assert done.returncode == -signal.SIGKILL


def visit(place: Path) -> None:
    with scratch.beside(place, exclusive=False):
        pass


@pytest.mark.parametrize("exclusive", [True, False])
def test_the_scratch_is_beside_the_place_hidden_and_gone_afterwards(tmp_path: Path, exclusive: bool) -> None:
    with scratch.beside(tmp_path / "deep" / "run", exclusive) as room:
        assert room.parent == tmp_path / "deep"
        assert room.name.startswith(".run.")
        assert scratch.is_scratch(room / "new")
        (room / "new").mkdir()
    assert os.listdir(tmp_path / "deep") == []


def test_only_one_at_a_time_works_for_a_place_exclusively(tmp_path: Path) -> None:
    with scratch.beside(tmp_path / "run", exclusive=True) as room:
        (room / "new").touch()
        with pytest.raises(InputError, match="run: another process is writing it"):
            visit_exclusively(tmp_path / "run")
        visit_exclusively(tmp_path / "other")
        visit(tmp_path / "run")
        assert (room / "new").exists()
    visit_exclusively(tmp_path / "run")


def visit_exclusively(place: Path) -> None:
    with scratch.beside(place, exclusive=True) as room:
        assert os.listdir(room) == [scratch.LOCK]


@pytest.mark.parametrize("kind", ["exclusive", "shared"])
def test_what_a_killed_process_left_is_swept_up_by_the_next_that_writes_there(tmp_path: Path, kind: str) -> None:
    kill_one_that_writes(tmp_path / "run", kind)
    (left,) = os.listdir(tmp_path)
    assert scratch.is_scratch(tmp_path / left / "new")
    visit(tmp_path / "other")
    assert os.listdir(tmp_path) == []


def test_what_a_killed_process_left_does_not_hinder_the_next_for_the_same_place(tmp_path: Path) -> None:
    kill_one_that_writes(tmp_path / "run", "exclusive")
    visit_exclusively(tmp_path / "run")
    assert os.listdir(tmp_path) == []


def test_what_a_killed_process_had_moved_aside_is_put_back(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "result.json").write_text("old", encoding="utf-8")
    kill_one_that_writes(tmp_path / "run", "exclusive")
    assert not (tmp_path / "run").exists()
    visit(tmp_path / "other")
    assert os.listdir(tmp_path) == ["run"]
    assert (tmp_path / "run" / "result.json").read_text(encoding="utf-8") == "old"


def test_a_folder_of_the_users_is_never_swept_up_whatever_its_name(tmp_path: Path) -> None:
    mine = tmp_path / f".thesis{scratch.SUFFIX}"
    mine.mkdir()
    (mine / "thesis.tex").touch()
    (tmp_path / f".link{scratch.SUFFIX}").symlink_to(mine)
    visit(tmp_path / "run")
    assert sorted(os.listdir(tmp_path)) == [f".link{scratch.SUFFIX}", mine.name]
    assert (mine / "thesis.tex").exists()


def test_a_long_name_has_a_scratch_of_its_own(tmp_path: Path) -> None:
    with scratch.beside(tmp_path / ("é" * 120), exclusive=True) as room:
        assert room.is_dir()
        visit_exclusively(tmp_path / ("é" * 119 + "e"))
