"""Films of runs."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.figures import animate
from scenarios.figures.film import Film, frame_rows
from scenarios.figures.palette import agent_colour, rgb
from scenarios.figures.style import print_style
from scenarios.measures.metrics import Metrics, measure
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

Run = tuple[Experiment, Trajectory, Metrics]


@pytest.fixture(scope="module")
def run() -> Run:
    experiment = open_experiment("shape", ("plant.name=saturated",), 4.0)
    trajectory = simulate(experiment, 0)
    return experiment, trajectory, measure(experiment, trajectory)


def silent(done: int, total: int) -> None:
    """No progress is shown."""


@given(speed=st.floats(0.1, 50.0), fps=st.floats(1.0, 60.0), steps=st.integers(2, 400))
def test_each_frame_shows_the_state_nearest_to_its_time(
    recorded: Callable[..., Trajectory], speed: float, fps: float, steps: int
) -> None:
    t = 0.033 * np.arange(steps)
    rows = frame_rows(recorded(t, np.zeros((steps, 3, 3)), np.zeros((steps, 3, 2))), speed, fps)
    assert rows[0] == 0
    assert rows[-1] == steps - 1
    assert (np.diff(rows) >= 0).all()
    wanted = np.arange(len(rows) - 1) * speed / fps
    assert np.abs(t[rows[:-1]] - wanted).max() <= 0.033 / 2.0 + 1e-9


def test_a_film_ends_with_the_last_finite_state(recorded: Callable[..., Trajectory]) -> None:
    poses = np.zeros((50, 3, 3))
    poses[40:] = np.nan
    trajectory = recorded(0.1 * np.arange(50), poses, np.zeros((50, 3, 2)))
    assert frame_rows(trajectory, 1.0, 10.0)[-1] == 39


def test_every_robot_is_seen_in_its_colour_where_it_is(run: Run) -> None:
    experiment, trajectory, _ = run
    with print_style():
        film = Film(*run, speed=4.0, fps=5.0)
        frames = [frame.copy() for frame in film.frames()]
        height = frames[0].shape[0]
        for row, frame in ((0, frames[0]), (-1, frames[-1])):
            pose = trajectory.poses[row]
            # Beside the white wedge, on the chassis.
            left = np.stack([-np.sin(pose[:, 2]), np.cos(pose[:, 2])], axis=1)
            ahead = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=1)
            spots = pose[:, :2] + 0.05 * ahead + 0.04 * left
            for agent, (x, y) in enumerate(film.floor.transData.transform(spots)):
                assert tuple(frame[height - 1 - int(y), int(x), :3]) == rgb(agent_colour(agent))
    assert experiment.n == 6


def test_a_gif_has_all_frames_and_lasts_as_long_as_the_run_at_its_speed(run: Run, tmp_path: Path) -> None:
    counted: list[tuple[int, int]] = []
    animate(*run, tmp_path / "a.gif", 2.0, 7.0, lambda done, total: counted.append((done, total)))
    with Image.open(tmp_path / "a.gif") as film:
        milliseconds = 0
        for frame in range(film.n_frames):
            film.seek(frame)
            milliseconds += film.info["duration"]
    frames = len(frame_rows(run[1], 2.0, 7.0))
    assert counted == [(done, frames) for done in range(1, frames + 1)]
    assert milliseconds == pytest.approx(1000.0 * frames / 7.0 + 1500.0, abs=10.0)
    assert list(tmp_path.iterdir()) == [tmp_path / "a.gif"]


def test_the_paper_of_a_gif_is_white(run: Run, tmp_path: Path) -> None:
    animate(*run, tmp_path / "a.gif", 4.0, 2.0, silent)
    with Image.open(tmp_path / "a.gif") as film:
        assert film.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


def test_two_gifs_of_one_run_are_the_same_bytes(run: Run, tmp_path: Path) -> None:
    for name in ("a.gif", "b.gif"):
        animate(*run, tmp_path / name, 4.0, 3.0, silent)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()


@pytest.mark.skipif(shutil.which("ffprobe") is None, reason="needs ffmpeg")
def test_an_mp4_has_the_frames_of_the_film_and_holds_the_last(run: Run, tmp_path: Path) -> None:
    animate(*run, tmp_path / "a.mp4", 4.0, 10.0, silent)
    probe = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0"]
    found = subprocess.run([*probe, str(tmp_path / "a.mp4")], capture_output=True, text=True, check=True)
    assert int(found.stdout) == len(frame_rows(run[1], 4.0, 10.0)) + 15


def test_without_ffmpeg_an_mp4_is_refused_before_anything_is_written(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"needs ffmpeg, which is not on the PATH"):
        animate(*run, tmp_path / "a.mp4", 4.0, 10.0, silent)
    assert not list(tmp_path.iterdir())


def test_when_ffmpeg_fails_its_last_line_is_the_error_and_no_file_is_left(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tools, out = tmp_path / "bin", tmp_path / "out"
    tools.mkdir()
    fake = tools / "ffmpeg"
    fake.write_text("#!/bin/sh\necho 'Unknown encoder libx264' >&2\nexit 1\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", str(tools))
    with pytest.raises(InputError, match=r"ffmpeg failed: Unknown encoder libx264"):
        animate(*run, out / "a.mp4", 4.0, 10.0, silent)
    assert not list(out.iterdir())


@pytest.mark.parametrize("suffix", ["gif", "mp4"])
def test_an_interrupted_film_leaves_the_older_one_and_nothing_else(run: Run, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(b"older")

    def interrupt(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate(*run, path, 4.0, 10.0, interrupt)
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def test_a_film_of_countless_frames_is_refused(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at most 20000 frames"):
        animate(*run, tmp_path / "a.gif", 1e-9, 20.0, silent)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("speed", "fps", "field"),
    [
        (0.0, 20.0, "--speed"),
        (np.nan, 20.0, "--speed"),
        (1.0, 0.0, "--fps"),
        (1.0, 60.0, "--fps"),
        (1.0, 1e-3, "--fps"),
        (1.0, np.nan, "--fps"),
        (1e300, 20.0, "--speed"),
    ],
)
def test_a_speed_or_frame_rate_that_cannot_be_shown_is_refused(
    run: Run, tmp_path: Path, speed: float, fps: float, field: str
) -> None:
    with pytest.raises(InputError, match=field):
        animate(*run, tmp_path / "a.gif", speed, fps, silent)
