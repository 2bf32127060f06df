"""Frames to GIF, WebP (Pillow) or MP4 (PyAV, which carries its encoder), into files that are whole or absent."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.figures.films.film import Film, Pixels
from scenarios.figures.films.layout import Frame
from scenarios.figures.style import print_style
from scenarios.measures.metrics import Metrics
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage.files import replacing

if TYPE_CHECKING:
    from av.video.frame import VideoFrame

HOLD = 1.5
"""Seconds for which the last frame stays."""

LEAST_FPS = 0.1
"""Frames per second, at least: a GIF counts a frame's hundredths of a second in 16 bits."""

FPS_LIMIT = {".gif": 50.0, ".webp": 50.0, ".mp4": 240.0}
"""Frames per second, at most: viewers show faster pictures that move slower, and no screen shows a faster film."""

FASTEST = 1e6
"""Simulated seconds per second: the longest run in a blink."""

X264 = {"crf": "20", "threads": "1", "mbtree": "0"}
"""Lines stay sharp, and a minute takes about a megabyte; with one thread the bytes depend on no processor's cores, and
without the tree of macroblocks not on what memory held before: x264 reads some of it there unwritten."""

COLOURS = 128
"""Of the palette of a GIF or a WebP; enough for the agents' colours and the steps between them and white."""

NEARLY_WHITE = 248

MAX_FRAMES = 20_000
"""Over five minutes of film at 60 frames per second; more is a slip of the keys."""

PIXELS = (160, 7680)
"""Of a frame's sides: below, nothing can be told apart; above, no screen shows it."""

LONGEST = 3.0
"""Times that one side is longer than the other, at most."""

OnFrame = Callable[[int, int], None]


def animate(
    experiment: Experiment,
    trajectory: Trajectory,
    metrics: Metrics,
    path: Path,
    speed: float,
    fps: float,
    frame: Frame,
    on_frame: OnFrame,
) -> None:
    """Write the film of a run as ``path``; see :func:`write_film`."""
    seconds = float(trajectory.t[-1])
    write_film(
        lambda: Film(experiment, trajectory, metrics, speed, fps, frame), seconds, path, speed, fps, frame, on_frame
    )


class Reel(Protocol):
    """What a film is made of; see :class:`scenarios.figures.films.film.Film`."""

    rows: NDArray[np.intp]
    size: tuple[int, int]

    def frames(self) -> Iterator[Pixels]: ...

    def last(self) -> Pixels: ...


def write_film(
    make: Callable[[], Reel], seconds: float, path: Path, speed: float, fps: float, frame: Frame, on_frame: OnFrame
) -> None:
    """Write a film.

    Args:
        make: makes the frames, in the style of print.
        seconds: that the run took.
        path: a .gif, .webp or .mp4 file; a WebP is a quarter of a GIF.
        speed: simulated seconds per second of film.
        fps: frames per second.
        frame: its pixels, which ``make`` knows of.
        on_frame: called after each frame with the number of frames done and of all frames.

    Raises:
        InputError: ``speed``, ``fps`` or the frame is out of range, or the file cannot be written.
    """
    _require_pixels("--width", frame.width)
    if frame.height is not None:
        _require_pixels("--height", frame.height)
        if not 1.0 / LONGEST <= frame.width / frame.height <= LONGEST:
            raise InputError(
                f"--height: expected at most {LONGEST:g} times as much or as little as --width, {frame.width}, "
                f"got {frame.height}"
            )
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
    write = _mp4 if path.suffix == ".mp4" else _moving_picture
    with print_style(), replacing(path) as scratch:
        write(make(), scratch, fps, on_frame)


def _require_pixels(option: str, pixels: int) -> None:
    low, high = PIXELS
    if not low <= pixels <= high:
        raise InputError(f"{option}: expected {low} to {high} pixels, got {pixels}")


def _moving_picture(film: Reel, path: Path, fps: float, on_frame: OnFrame) -> None:
    total = len(film.rows)
    images = _reduced(film, on_frame)
    first = next(images)
    # A GIF counts in hundredths of a second: each frame's share is rounded so that the errors do not add up.
    ends = np.rint(100.0 * np.arange(1, total + 1) / fps)
    durations = (10.0 * np.diff(ends, prepend=0.0)).astype(int)
    durations[-1] += int(1000.0 * HOLD)
    options: dict[str, Any] = {"save_all": True, "append_images": images, "duration": durations.tolist(), "loop": 0}
    with path.open("wb") as file:
        if path.suffix == ".gif":
            first.save(file, "GIF", optimize=False, **options)
        else:
            first.save(file, "WEBP", lossless=True, method=4, minimize_size=True, **options)


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


def _planes(pixels: Pixels) -> VideoFrame:
    """A frame in the encoder's colours, rounded alike wherever in memory the pixels happen to lie."""
    import av
    from av.video.reformatter import Interpolation

    frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(pixels), format="rgba")
    exact = Interpolation.BILINEAR | Interpolation.ACCURATE_RND | Interpolation.BITEXACT
    return frame.reformat(format="yuv420p", interpolation=exact, threads=1)


def _mp4(film: Reel, path: Path, fps: float, on_frame: OnFrame) -> None:
    import av  # loads 70 MB of codecs

    total = len(film.rows)
    with path.open("wb") as file, av.open(file, "w", format="mp4", options={"fflags": "+bitexact"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000), options=X264)
        stream.width, stream.height = film.size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.flags |= av.codec.context.Flags.bitexact
        for done, pixels in enumerate(film.frames(), start=1):
            frame = _planes(pixels)
            for _ in range(1 + round(HOLD * fps) if done == total else 1):
                frame.pts = None
                container.mux(stream.encode(frame))
            on_frame(done, total)
        container.mux(stream.encode())
