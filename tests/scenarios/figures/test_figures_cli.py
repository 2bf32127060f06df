"""Run folders read back, and the commands that draw from them."""

from __future__ import annotations

import errno
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from scenarios.cli import BAD_INPUT, DONE
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.one_run import run_to_folder
from scenarios.storage import files, run_folder
from scenarios.storage.run_folder import read

Cli = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    experiment = open_experiment("maneuver", ("plant.name=saturated", "goal.angle_error_sum_rad=0.02"), 70.0)
    run_to_folder(experiment, 3, folder, Console(file=io.StringIO()))
    return folder


@pytest.fixture
def copy(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


def refused(cli: Cli, *arguments: str) -> str:
    code, _, message = cli(*arguments)
    assert code == BAD_INPUT
    assert message.startswith("formation: ")
    assert message.count("\n") == 1
    return message


def test_a_run_read_back_is_the_run_that_was_made(finished: Path) -> None:
    again = read(finished)
    assert again.experiment.scenario.goal.angle_error_sum_rad == 0.02
    assert [phase.duration for phase in again.experiment.phases] == [50.0, 20.0]
    assert again.experiment.file.sha256 == again.result["scenario_sha256"]
    assert again.result["seed"] == 3
    with np.load(finished / run_folder.TRAJECTORY) as data:
        np.testing.assert_array_equal(again.trajectory.poses, data["poses"])


def test_times_of_the_overview_are_checked_before_anything_is_drawn(copy: Path, cli: Cli) -> None:
    assert "--at: expected seconds, separated by commas, got '1;2'" in refused(cli, "plot", str(copy), "--at", "1;2")
    assert "at: expected seconds of the run, 0 to 70, got 71" in refused(cli, "plot", str(copy), "--at", "1,71")
    assert not (copy / "figure-graph.png").exists()


def test_a_run_leaves_its_overview_as_a_picture(finished: Path) -> None:
    assert (finished / "figure-motion.png").read_bytes().startswith(b"\x89PNG")


def test_plot_draws_what_the_run_drew(finished: Path, tmp_path: Path, cli: Cli) -> None:
    assert cli("plot", str(finished), "--out", str(tmp_path), "--format", "png", "--format", "svg")[0] == DONE
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {f"figure-{n}.{f}" for n in ("graph", "motion", "decay", "separation") for f in ("png", "svg")}
    assert (tmp_path / "figure-motion.png").read_bytes() == (finished / "figure-motion.png").read_bytes()


def test_animate_writes_a_film_into_the_run_folder(copy: Path, cli: Cli) -> None:
    assert cli("animate", str(copy), "--speed", "20", "--fps", "2")[0] == DONE
    assert (copy / "animation.gif").read_bytes().startswith(b"GIF8")


@pytest.mark.parametrize("command", ["plot", "animate"])
def test_a_missing_folder_is_one_line(command: str, tmp_path: Path, cli: Cli) -> None:
    assert "no such run folder" in refused(cli, command, str(tmp_path / "absent"))
    assert "not a run folder" in refused(cli, command, str(tmp_path))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("trajectory.npz", b"PK not an archive"),
        ("result.json", b"{"),
        ("result.json", b"[]"),
        ("result.json", b'{"scenario": "x", "seed": 0}'),
        ("scenario.json", b'{"title": "x", "speed": 1}'),
        ("scenario.json", b"\xff"),
    ],
)
def test_a_damaged_file_is_named_in_one_line(name: str, content: bytes, copy: Path, cli: Cli) -> None:
    (copy / name).write_bytes(content)
    assert name in refused(cli, "plot", str(copy))


@pytest.mark.parametrize("part", [0.2, 0.6, 0.99])
def test_a_truncated_trajectory_is_named_in_one_line(part: float, copy: Path, cli: Cli) -> None:
    path = copy / run_folder.TRAJECTORY
    path.write_bytes(path.read_bytes()[: int(part * path.stat().st_size)])
    assert run_folder.TRAJECTORY in refused(cli, "plot", str(copy))


def test_a_trajectory_of_another_number_of_robots_is_refused(copy: Path) -> None:
    trajectory = read(copy).trajectory
    with np.load(copy / run_folder.TRAJECTORY) as data:
        arrays = dict(data)
    arrays["poses"] = trajectory.poses[:, :4]
    np.savez_compressed(copy / run_folder.TRAJECTORY, **arrays)
    with pytest.raises(InputError, match=r"poses: expected the shape \(\d+, 6, 3\), got \(\d+, 4, 3\)"):
        read(copy)


def test_a_missing_scenario_is_named(copy: Path) -> None:
    (copy / run_folder.SCENARIO).unlink()
    with pytest.raises(InputError, match=r"scenario\.json: cannot be read"):
        read(copy)


def test_an_unknown_format_is_one_line(finished: Path, cli: Cli) -> None:
    assert "bmp" in refused(cli, "plot", str(finished), "--format", "bmp")
    assert "avi" in refused(cli, "animate", str(finished), "--format", "avi")


def test_a_place_that_cannot_be_written_is_one_line(finished: Path, tmp_path: Path, cli: Cli) -> None:
    (tmp_path / "file").write_text("in the way")
    for command in ("plot", "animate"):
        message = refused(cli, command, str(finished), "--out", str(tmp_path / "file" / "x"))
        assert "cannot be written" in message


def full_disk(*_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_full_disk_is_one_line_and_leaves_older_figures_whole(
    copy: Path, monkeypatch: pytest.MonkeyPatch, cli: Cli
) -> None:
    before = {path.name: path.read_bytes() for path in copy.iterdir()}
    monkeypatch.setattr(files.Path, "write_bytes", full_disk)
    assert "No space left on device" in refused(cli, "plot", str(copy))
    assert {path.name: path.read_bytes() for path in copy.iterdir()} == before


def test_a_disk_that_fills_during_a_run_leaves_the_older_run_whole(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    older = json.loads((copy / run_folder.RESULT).read_text())
    monkeypatch.setattr(run_folder, "write_json", full_disk)
    with pytest.raises(InputError, match="No space left on device"):
        run_to_folder(open_experiment("shape", (), 1.0), 0, copy, Console(file=io.StringIO()))
    assert json.loads((copy / run_folder.RESULT).read_text()) == older
    assert [path.name for path in copy.parent.iterdir()] == [copy.name]
