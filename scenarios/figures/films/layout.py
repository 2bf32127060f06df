"""Where a film's floor and its curve of angle errors lie on a frame, whose pixels are chosen."""

from __future__ import annotations

from dataclasses import dataclass

from scenarios.figures.floor import Limits

Box = tuple[float, float, float, float]
"""(left, bottom, width, height), inches."""

WIDTH, WIDE = 5.0, 7.2
"""Inches of a frame on which all stands in one column, and of one with the curve beside the floor: type keeps its size
in inches, and the eye sees a wide frame from farther away."""

LEFT, RIGHT, BOTTOM, ERRORS, BETWEEN, TOP = 0.50, 0.14, 0.36, 0.70, 0.56, 0.26
BESIDE, NARROWEST = 0.62, 1.5
"""From the floor to the curve beside it, and what is left for the curve at least."""

TALLEST_FLOOR = 4.2
NUDGED = 1.0 + 1e-12
"""Times inches that are as many pixels as they should be: none is lost where these are rounded down."""


@dataclass(frozen=True)
class Frame:
    """What a frame measures.

    Attributes:
        width: pixels.
        height: pixels; None for what the floor's shape gives.
    """

    width: int = 720
    height: int | None = None

    def inches(self, width: float) -> tuple[float, float | None]:
        """The dots per inch where the frame is so many inches wide, and the inches of its height where that is told."""
        dots = self.width / width * NUDGED
        return dots, None if self.height is None else self.height / dots * NUDGED


@dataclass(frozen=True)
class Layout:
    """The places on a frame, inches.

    Attributes:
        size: of the frame.
        dots_per_inch: of its pixels.
        floor: where the robots move.
        errors: where the curve is.
    """

    size: tuple[float, float]
    dots_per_inch: float
    floor: Box
    errors: Box


def layout(frame: Frame, shown: Limits, curve: bool = True) -> Layout:
    """The curve below the floor; beside it where the frame's height is told and the floor is larger so.

    Args:
        frame: its pixels.
        shown: the part of the floor that is seen, metres.
        curve: whether there is one; without, the place for it is left out.
    """
    slope = (shown[3] - shown[2]) / (shown[1] - shown[0])
    below = _below(frame, slope, curve)
    beside = _beside(frame, slope) if curve and frame.height is not None else below
    return max(below, beside, key=lambda made: made.floor[2] * made.dots_per_inch)


def even(size: tuple[int, int]) -> tuple[int, int]:
    """The pixels of a frame without what is odd, as video codecs want them."""
    return size[0] - size[0] % 2, size[1] - size[1] % 2


def _below(frame: Frame, slope: float, curve: bool) -> Layout:
    under = BOTTOM + (ERRORS + BETWEEN if curve else 0.0)
    room = WIDTH - LEFT - RIGHT
    dots, total = frame.inches(WIDTH)
    tallest = TALLEST_FLOOR if total is None else total - under - TOP
    width, height = _fitted(room, tallest, slope)
    if total is None:
        return Layout((WIDTH, under + height + TOP), dots, (LEFT, under, width, height), (LEFT, BOTTOM, room, ERRORS))
    spare = tallest - height  # which the curve takes
    floor = (LEFT + (room - width) / 2.0, under + spare, width, height)
    return Layout((WIDTH, total), dots, floor, (LEFT, BOTTOM, room, ERRORS + spare))


def _beside(frame: Frame, slope: float) -> Layout:
    dots, total = frame.inches(WIDE)
    tallest = (total or 0.0) - BOTTOM - TOP
    width, height = _fitted(WIDE - LEFT - RIGHT - BESIDE - NARROWEST, tallest, slope)
    bottom = BOTTOM + (tallest - height) / 2.0
    right = LEFT + width + BESIDE
    return Layout(
        (WIDE, total or 0.0), dots, (LEFT, bottom, width, height), (right, bottom, WIDE - RIGHT - right, height)
    )


def _fitted(width: float, height: float, slope: float) -> tuple[float, float]:
    """The largest size of height over width ``slope`` within a room."""
    room = max(height, 0.1)
    return (width, width * slope) if width * slope <= room else (room / slope, room)
