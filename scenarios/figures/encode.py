"""Frames to GIF (Pillow) or MP4 (ffmpeg), into files that are whole or absent."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.figures.film import Film, Pixels
from scenarios.figures.style import print_style
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import replacing

HOLD = 1.5
"""Seconds for which the last frame stays."""

GIF_FPS_LIMIT = 50.0
"""Viewers show faster GIFs slower."""

LEAST_FPS, FPS_LIMIT = 0.1, 1000.0
"""Frames that stay for ten seconds; and more than any screen shows."""

FASTEST = 1e6
"""Simulated seconds per second: the longest run in a blink."""

COLOURS = 128
"""Of a GIF's palette; enough for the agents' colours and the steps between them and white."""

NEARLY_WHITE = 248

MAX_FRAMES = 20_000
"""Over five minutes of film at 60 frames per second; more is a slip of the keys."""

OnFrame = Callable[[int, int], None]


def animate(
    experiment: Experiment,
    trajectory: Trajectory,
    metrics: Metrics,
    path: Path,
    speed: float,
    fps: float,
    on_frame: OnFrame,
) -> None:
    """Write the film of a run as ``path``; see :func:`write_film`."""
    write_film(
        lambda: Film(experiment, trajectory, metrics, speed, fps), float(trajectory.t[-1]), path, speed, fps, on_frame
    )


class Reel(Protocol):
    """What a film is made of; see :class:`scenarios.figures.film.Film`."""

    rows: NDArray[np.intp]
    size: tuple[int, int]

    def frames(self) -> Iterator[Pixels]: ...

    def last(self) -> Pixels: ...


def write_film(
    make: Callable[[], Reel], seconds: float, path: Path, speed: float, fps: float, on_frame: OnFrame
) -> None:
    """Write a film as ``path``, a .gif or .mp4 file.

    Args:
        make: makes the frames, in the style of print.
        seconds: that the run took.
        path: its suffix chooses the kind.
        speed: simulated seconds per second of film.
        fps: frames per second.
        on_frame: called after each frame with the number of frames done and of all frames.

    Raises:
        InputError: ``speed`` or ``fps`` is out of range, ffmpeg is missing or fails, or the file cannot be written.
    """
    if not 0.0 < speed <= FASTEST:
        raise InputError(f"--speed: expected a positive number up to {FASTEST:g}, got {speed:g}")
    gif = path.suffix == ".gif"
    most, why = (GIF_FPS_LIMIT, ", which is what viewers of GIFs can show") if gif else (FPS_LIMIT, "")
    if not LEAST_FPS <= fps <= most:
        raise InputError(f"--fps: expected a number from {LEAST_FPS:g} to {most:g}{why}, got {fps:g}")
    wanted = seconds * fps / speed
    if not wanted <= MAX_FRAMES:
        raise InputError(
            f"--speed, --fps: expected at most {MAX_FRAMES} frames, {speed:g} and {fps:g} make {wanted:.3g}"
        )
    ffmpeg = None if gif else shutil.which("ffmpeg")
    if not gif and ffmpeg is None:
        raise InputError("--format mp4: needs ffmpeg, which is not on the PATH; --format gif does not")
    with print_style(), replacing(path) as scratch:
        film = make()
        if ffmpeg is None:
            _gif(film, scratch, fps, on_frame)
        else:
            _mp4(film, scratch, fps, on_frame, ffmpeg)


def _gif(film: Reel, path: Path, fps: float, on_frame: OnFrame) -> None:
    total = len(film.rows)
    images = _reduced(film, on_frame)
    first = next(images)
    # A GIF counts in hundredths of a second: each frame's share is rounded so that the errors do not add up.
    ends = np.rint(100.0 * np.arange(1, total + 1) / fps)
    durations = (10.0 * np.diff(ends, prepend=0.0)).astype(int)
    durations[-1] += int(1000.0 * HOLD)
    with path.open("wb") as file:
        first.save(
            file, "GIF", save_all=True, append_images=images, duration=durations.tolist(), loop=0, optimize=False
        )


def _reduced(film: Reel, on_frame: OnFrame) -> Iterator[Image.Image]:
    """The frames in one palette, that of the last and busiest frame."""
    total = len(film.rows)
    palette = _palette(film.last())
    for done, pixels in enumerate(film.frames(), start=1):
        yield _rgb(pixels).quantize(palette=palette, dither=Image.Dither.NONE)
        on_frame(done, total)


def _palette(pixels: Pixels) -> Image.Image:
    """A picture that carries a palette for the colours of a frame, with pure white in place of all nearly white."""
    found = _rgb(pixels).quantize(COLOURS - 1, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).getpalette() or []
    colours = np.array(found, dtype=np.uint8).reshape(-1, 3)[: COLOURS - 1]
    palette = Image.new("P", (1, 1))
    palette.putpalette([255, 255, 255, *colours[colours.min(axis=1) < NEARLY_WHITE].ravel().tolist()])
    return palette


def _rgb(pixels: Pixels) -> Image.Image:
    return Image.fromarray(pixels[..., :3].copy())


def _mp4(film: Reel, path: Path, fps: float, on_frame: OnFrame, ffmpeg: str) -> None:
    width, height = film.size
    command = [ffmpeg, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}"]
    command += ["-r", f"{fps:g}", "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20"]
    command += ["-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v", "+bitexact", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        try:
            if process.stdin is not None:
                _feed(film, process.stdin, fps, on_frame)
            complaint = process.stderr.read().decode(errors="replace") if process.stderr is not None else ""
        except BaseException:
            process.kill()
            raise
    if process.returncode != 0:
        lines = complaint.strip().splitlines() or [f"exit code {process.returncode}"]
        raise InputError(f"{path.name}: ffmpeg failed: {lines[-1]}")


def _feed(film: Reel, pipe: IO[bytes], fps: float, on_frame: OnFrame) -> None:
    """Write all frames, the last one repeated; ends early when ffmpeg closes the pipe, and then it says why itself."""
    total = len(film.rows)
    try:
        for done, pixels in enumerate(film.frames(), start=1):
            frame = pixels.tobytes()
            for _ in range(1 + round(HOLD * fps) if done == total else 1):
                pipe.write(frame)
            on_frame(done, total)
        pipe.close()
    except BrokenPipeError:
        return
