"""Pictures of a script's figure while it runs, and its figures at the end.

How long a script runs is not known, so that pictures are taken ever more rarely: whenever there are too many, every
second one is dropped.
"""

from __future__ import annotations

import io
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robots.model import CONTROL_PERIOD
from robots.rps.robotarium import Robotarium

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Real = NDArray[np.float64]

MOST = 48
"""Pictures, at most."""

FIRST_EVERY = 15
"""Steps, half a second, between two pictures in the beginning."""

DOTS_PER_INCH = 80
FINAL_DOTS_PER_INCH = 150


@dataclass(frozen=True, eq=False)
class Frames:
    """Pictures of a script's figure.

    Attributes:
        t: (k,) seconds.
        pictures: of each, the content of a PNG file.
    """

    t: Real
    pictures: tuple[bytes, ...]


class Camera:
    """Takes the pictures of the figure that a script draws into: the robots' own, or else its first."""

    def __init__(self) -> None:
        self._every = FIRST_EVERY
        self._steps: list[int] = []
        self._pictures: list[bytes] = []
        self._whose: Robotarium | None = None

    def look(self, robots: Robotarium) -> None:
        """Take a picture, if it is time and there is a figure."""
        if self._whose is not robots:  # a new set of robots begins anew
            self._whose, self._every, self._steps, self._pictures = robots, FIRST_EVERY, [], []
        if robots.steps % self._every or (figure := drawn(robots)) is None:
            return
        self._steps.append(robots.steps)
        self._pictures.append(png(figure, DOTS_PER_INCH))
        if len(self._steps) > MOST:
            self._every *= 2
            kept = [k for k, step in enumerate(self._steps) if step % self._every == 0]
            self._steps = [self._steps[k] for k in kept]
            self._pictures = [self._pictures[k] for k in kept]

    def frames(self, robots: Robotarium) -> Frames:
        """The pictures of these robots, the last one as the script has left it."""
        if self._whose is not robots:
            return Frames(np.empty(0), ())
        if (figure := drawn(robots)) is not None and self._steps[-1:] != [robots.steps]:
            self._steps.append(robots.steps)
            self._pictures.append(png(figure, DOTS_PER_INCH))
        return Frames(CONTROL_PERIOD * np.array(self._steps, dtype=np.float64), tuple(self._pictures))


def drawn(robots: Robotarium) -> Figure | None:
    """The figure that a script draws into; None while it draws into none."""
    return next(iter(all_drawn(robots)), None)


def all_drawn(robots: Robotarium) -> list[Figure]:
    """All figures that a script draws into, the robots' own first."""
    if "matplotlib.pyplot" not in sys.modules:
        return []
    from matplotlib._pylab_helpers import Gcf  # pyplot itself tells of figures only by making them current

    own = robots.picture
    others = [manager.canvas.figure for manager in Gcf.get_all_fig_managers()]
    found = [figure for figure in others if (own is None or figure is not own.figure) and figure.get_axes()]
    return [own.figure, *found] if own is not None and own.used() else found


def png(figure: Figure, dots_per_inch: float) -> bytes:
    """A picture of a figure as it is now."""
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=dots_per_inch)
    return content.getvalue()
