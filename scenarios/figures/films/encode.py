"""Frames to GIF (Pillow) or MP4 (PyAV, which carries its encoder), into files that are whole or absent."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.figures.films.film import Film, Pixels
from scenarios.figures.style import print_style
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import replacing

HOLD = 1.5
"""Seconds for which the last frame stays."""

LEAST_FPS = 0.1
"""Frames per second, at least: a GIF counts a frame's hundredths of a second in 16 bits."""

FPS_LIMIT = {".gif": 50.0, ".mp4": 240.0}
"""Frames per second, at most: viewers show faster GIFs slower, and no screen shows a faster film."""

FASTEST = 1e6
"""Simulated seconds per second: the longest run in a blink."""

X264 = {"crf": "20", "threads": "1"}
"""Lines stay sharp, and a minute takes about a megabyte; with one thread the bytes depend on no processor's cores."""

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
    """What a film is made of; see :class:`scenarios.figures.films.film.Film`."""

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
        InputError: ``speed`` or ``fps`` is out of range, or the file cannot be written.
    """
    if not 0.0 < speed <= FASTEST:
        raise InputError(f"--speed: expected a positive number up to {FASTEST:g}, got {speed:g}")
    kind, most = path.suffix[1:], FPS_LIMIT[path.suffix]
    if not LEAST_FPS <= fps <= most:
        raise InputError(
            f"--fps: expected a number from {LEAST_FPS:g} to {most:g}, which is what viewers of "
            f"{kind} can show, got {fps:g}"
        )
    wanted = seconds * fps / speed
    if not wanted <= MAX_FRAMES:
        raise InputError(
            f"--speed, --fps: expected at most {MAX_FRAMES} frames, {speed:g} and {fps:g} make {wanted:.3g}"
        )
    write = _gif if path.suffix == ".gif" else _mp4
    with print_style(), replacing(path) as scratch:
        write(make(), scratch, fps, on_frame)


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


def _mp4(film: Reel, path: Path, fps: float, on_frame: OnFrame) -> None:
    import av  # loads 70 MB of codecs

    total = len(film.rows)
    with path.open("wb") as file, av.open(file, "w", format="mp4", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000), options=X264)
        stream.width, stream.height = film.size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.flags |= av.codec.context.Flags.bitexact
        for done, pixels in enumerate(film.frames(), start=1):
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(pixels), format="rgba")
            for _ in range(1 + round(HOLD * fps) if done == total else 1):
                frame.pts = None
                container.mux(stream.encode(frame))
            on_frame(done, total)
        container.mux(stream.encode())
