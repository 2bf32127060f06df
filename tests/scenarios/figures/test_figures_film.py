"""Films of runs."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.figures import animate
from scenarios.figures.films import encode
from scenarios.figures.films.film import Film, frame_rows
from scenarios.figures.films.layout import Frame, layout
from scenarios.figures.floor import Limits
from scenarios.figures.palette import agent_colour, rgb
from scenarios.figures.style import print_style
from scenarios.measures.metrics import Metrics, measure
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

Run = tuple[Experiment, Trajectory, Metrics]

FRAME = Frame()


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
        film = Film(*run, speed=4.0, fps=5.0, frame=FRAME)
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
    animate(*run, tmp_path / "a.gif", 2.0, 7.0, FRAME, lambda done, total: counted.append((done, total)))
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
    animate(*run, tmp_path / "a.gif", 4.0, 2.0, FRAME, silent)
    with Image.open(tmp_path / "a.gif") as film:
        assert film.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


def test_two_gifs_of_one_run_are_the_same_bytes(run: Run, tmp_path: Path) -> None:
    for name in ("a.gif", "b.gif"):
        animate(*run, tmp_path / name, 4.0, 3.0, FRAME, silent)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()


def decoded(path: Path) -> list[np.ndarray]:
    with av.open(str(path)) as film:
        return [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]


def test_an_mp4_has_the_frames_of_the_film_and_holds_the_last(run: Run, tmp_path: Path) -> None:
    animate(*run, tmp_path / "a.mp4", 4.0, 10.0, FRAME, silent)
    frames = decoded(tmp_path / "a.mp4")
    assert len(frames) == len(frame_rows(run[1], 4.0, 10.0)) + 15
    with print_style():
        drawn = [frame[..., :3].astype(int) for frame in Film(*run, speed=4.0, fps=10.0, frame=FRAME).frames()]
    for k in (0, len(drawn) // 2, len(drawn) - 1):
        assert frames[k].shape == drawn[k].shape
        assert np.abs(frames[k] - drawn[k]).mean() < 2.0  # of 255
    assert np.abs(frames[-1] - drawn[-1]).mean() < 2.0


@pytest.mark.parametrize("fps", [0.5, 12.5])
def test_an_mp4_lasts_as_long_as_the_run_at_its_speed(run: Run, tmp_path: Path, fps: float) -> None:
    speed = 0.4 * fps
    animate(*run, tmp_path / "a.mp4", speed, fps, FRAME, silent)
    with av.open(str(tmp_path / "a.mp4")) as film:
        stream = film.streams.video[0]
        seconds = float(stream.duration * stream.time_base)
        assert float(stream.average_rate) == pytest.approx(fps)
    frames = len(frame_rows(run[1], speed, fps)) + round(1.5 * fps)
    assert seconds == pytest.approx(frames / fps, abs=0.5 / fps)


def test_two_mp4s_of_one_run_are_the_same_bytes(run: Run, tmp_path: Path) -> None:
    for name in ("a.mp4", "b.mp4"):
        animate(*run, tmp_path / name, 8.0, 3.0, FRAME, silent)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


FILM = """
import hashlib, sys
from pathlib import Path
from scenarios.definition.experiment import open_experiment
from scenarios.figures.films.encode import animate
from scenarios.figures.films.layout import Frame
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate
shape = open_experiment("shape", (), 20.0)
trajectory = simulate(shape)
animate(shape, trajectory, measure(shape, trajectory), Path(sys.argv[1]), 8.0, 3.0, Frame(), lambda *_: None)
print(hashlib.sha256(Path(sys.argv[1]).read_bytes()).hexdigest())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="glibc fills memory with what it is told")
def test_an_mp4_does_not_depend_on_what_memory_held_before(tmp_path: Path) -> None:
    found = set()
    for fill in ("1", "3"):
        told = os.environ | {"MALLOC_PERTURB_": fill, "MALLOC_MMAP_THRESHOLD_": "4000000000"}
        code = [sys.executable, "-c", FILM, str(tmp_path / "a.mp4")]
        found.add(subprocess.run(code, capture_output=True, text=True, check=True, env=told).stdout)
    assert len(found) == 1


@pytest.mark.parametrize("write", [encode._moving_picture, encode._mp4])
def test_a_film_for_a_full_disk_is_refused_with_the_systems_reason(run: Run, write: Callable[..., None]) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    with print_style(), pytest.raises(OSError, match="No space left"):
        write(Film(*run, speed=4.0, fps=4.0, frame=FRAME), Path("/dev/full"), 4.0, silent)


@pytest.mark.parametrize("suffix", ["gif", "mp4"])
def test_an_interrupted_film_leaves_the_older_one_and_nothing_else(run: Run, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(b"older")

    def interrupt(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate(*run, path, 4.0, 10.0, FRAME, interrupt)
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def test_a_film_of_countless_frames_is_refused(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at most 20000 frames"):
        animate(*run, tmp_path / "a.gif", 1e-9, 20.0, FRAME, silent)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["gif", "mp4"])
@pytest.mark.parametrize(
    ("speed", "fps", "field"),
    [
        (0.0, 20.0, "--speed"),
        (np.nan, 20.0, "--speed"),
        (1.0, 0.0, "--fps"),
        (1.0, 0.001, "--fps"),
        (1.0, np.nan, "--fps"),
        (1.0, 1e9, "--fps"),
        (1e300, 20.0, "--speed"),
    ],
)
def test_a_speed_or_frame_rate_that_cannot_be_shown_is_refused(
    run: Run, tmp_path: Path, speed: float, fps: float, field: str, suffix: str
) -> None:
    with pytest.raises(InputError, match=field):
        animate(*run, tmp_path / f"a.{suffix}", speed, fps, FRAME, silent)
    assert not list(tmp_path.iterdir())


def test_the_slowest_film_is_written(run: Run, tmp_path: Path) -> None:
    for suffix in ("gif", "mp4"):
        animate(*run, tmp_path / f"a.{suffix}", 0.2, 0.1, FRAME, silent)


SHOWN = (-1.76, 1.76, -1.16, 1.16)


@given(
    width=st.integers(160, 4000),
    height=st.none() | st.integers(160, 4000),
    shown=st.tuples(st.just(0.0), st.floats(0.5, 20.0), st.just(0.0), st.floats(0.5, 20.0)),
    curve=st.booleans(),
)
def test_a_frame_has_the_pixels_that_were_asked_for_and_shows_the_floor_undistorted(
    width: int, height: int | None, shown: Limits, curve: bool
) -> None:
    if height is not None and not 1.0 / encode.LONGEST <= width / height <= encode.LONGEST:
        return
    made = layout(Frame(width, height), shown, curve)
    figure = Figure(figsize=made.size, dpi=made.dots_per_inch)
    pixels = FigureCanvasAgg(figure).get_width_height()
    assert pixels[0] == width
    assert height is None or pixels[1] == height
    left, bottom, wide, high = made.floor
    assert high / wide == pytest.approx(shown[3] / shown[1])
    assert min(left, bottom) > 0.0
    assert left + wide <= made.size[0]
    assert bottom + high <= made.size[1] + 1e-9


def test_a_frame_for_slides_has_the_curve_beside_the_floor_and_the_floor_as_high_as_can_be() -> None:
    made = layout(Frame(1920, 1080), SHOWN)
    assert made.errors[0] > made.floor[0] + made.floor[2]
    assert made.floor[2] / made.size[0] > 0.6
    tall = layout(Frame(1080, 1350), SHOWN)
    assert tall.errors[1] + tall.errors[3] < tall.floor[1]


@pytest.mark.parametrize("form", ["gif", "webp", "mp4"])
def test_a_film_has_the_width_and_height_that_were_asked_for(run: Run, tmp_path: Path, form: str) -> None:
    path = tmp_path / f"a.{form}"
    animate(*run, path, 8.0, 3.0, Frame(401, 300), silent)
    if form == "webp":
        with Image.open(path) as film:
            assert film.size == (400, 300)
            assert film.n_frames > 1
    else:
        with av.open(str(path)) as video:
            frame = next(video.decode(video=0))
        assert (frame.width, frame.height) == (400, 300)


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (Frame(100), "--width: expected 160 to 7680 pixels, got 100"),
        (Frame(720, 9000), "--height: expected 160 to 7680 pixels, got 9000"),
        (Frame(1920, 300), "--height: expected at most 3 times as much or as little as --width, 1920, got 300"),
    ],
)
def test_a_frame_that_no_screen_has_is_refused(run: Run, tmp_path: Path, frame: Frame, message: str) -> None:
    with pytest.raises(InputError) as caught:
        animate(*run, tmp_path / "a.mp4", 4.0, 3.0, frame, silent)
    assert str(caught.value) == message
    assert list(tmp_path.iterdir()) == []
