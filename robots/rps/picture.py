"""The figure that scripts draw into: the arena and its robots, drawn as they are when the figure is.

A figure costs nothing while robots move: they are put in their places when something draws it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robots.rps import constants
from robots.rps.columns import Real
from robots.rps.distances import endpoints
from robots.rps.version2.gternal_patch import GTERNALRobotPatch, gternal_patch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BEHIND = -1000.0
"""Drawing order of what brings the others to their places: before all of them."""

Artists = list[Any]


@dataclass(frozen=True)
class Look:
    """What a figure shows.

    Attributes:
        margin: metres of ground around the arena.
        inches: of the figure per metre.
        arena, robots, endpoints, rays, obstacles: whether they are drawn.
    """

    margin: float = 0.05
    inches: float = 2.5
    arena: bool = True
    robots: bool = True
    endpoints: bool = False
    rays: bool = False
    obstacles: bool = True


class Picture:
    """A figure of pyplot's with the arena in it.

    Args:
        poses: gives (3, N) poses at the moment of drawing.
        lights: gives (3, N) the colours of the lamps, 0 to 255, or None where they are not lit.
        distances: gives (7, N) readings of the distance sensors.
        obstacles: (M, 2, 2) lines, metres, or None.
        look: what is shown.
    """

    def __init__(
        self,
        poses: Callable[[], Real],
        lights: Callable[[], Real | None],
        distances: Callable[[], Real],
        obstacles: Real | None,
        look: Look,
    ) -> None:
        import matplotlib.pyplot as plt

        low_x, high_x, low_y, high_y = constants.BOUNDARIES
        size = np.array([high_x - low_x, high_y - low_y]) + 2.0 * look.margin
        self.figure: Figure
        self.axes: Axes
        self.figure, self.axes = plt.subplots(figsize=tuple(size * look.inches))
        self.axes.set(
            aspect="equal",
            xlim=(low_x - look.margin, high_x + look.margin),
            ylim=(low_y - look.margin, high_y + look.margin),
        )
        self.axes.set_axis_off()
        self.figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.99)
        if look.arena:
            from matplotlib.patches import Rectangle

            self.axes.add_patch(
                Rectangle((low_x, low_y), high_x - low_x, high_y - low_y, fill=False, edgecolor="black", linewidth=2.0)
            )
        if look.obstacles and obstacles is not None:
            for one, other in obstacles:
                self.axes.plot(*zip(one, other, strict=True), color="0.5", linewidth=4.0, scalex=False, scaley=False)
        self.chassis, self._rays, self._ends = self._movers(poses(), look)
        self.axes.add_artist(_mover(lambda: self._move(poses(), lights(), distances())))
        self._own = len(self.axes.get_children())

    def used(self) -> bool:
        """Whether a script has drawn into the axes."""
        return len(self.axes.get_children()) > self._own

    def _movers(self, poses: Real, look: Look) -> tuple[list[GTERNALRobotPatch], Artists, Artists]:
        data, colours = gternal_patch(), [f"C{robot % 10}" for robot in range(poses.shape[1])]
        chassis = [GTERNALRobotPatch(self.axes, pose, data) for pose in poses.T] if look.robots else []
        sensors = range(constants.DISTANCE_SENSORS_ORIENTATION.shape[1])
        rays = [
            [self.axes.plot([], [], color=colour, linewidth=0.5)[0] for _ in sensors]
            for colour in (colours if look.rays else [])
        ]
        ends = [
            self.axes.plot([], [], linestyle="", marker="o", markersize=7.0, color=colour)[0]
            for colour in (colours if look.endpoints else [])
        ]
        return chassis, rays, ends

    def _move(self, poses: Real, lights: Real | None, distances: Real) -> None:
        for robot, patch in enumerate(self.chassis):
            patch.set_pose(poses[:, robot])
            if lights is not None:
                patch.set_led(lights[:, robot])
        if not (self._rays or self._ends):
            return
        sensors = constants.DISTANCE_SENSORS_ORIENTATION
        seen, origins = endpoints(poses, sensors, distances), endpoints(poses, sensors, np.zeros_like(distances))
        for robot, lines in enumerate(self._rays):
            for sensor, line in enumerate(lines):
                line.set_data(*np.stack([origins[:, sensor, robot], seen[:, sensor, robot]], axis=1))
        for robot, points in enumerate(self._ends):
            points.set_data(*seen[:, :, robot])


def _mover(move: Callable[[], None]) -> Any:
    """An artist that draws nothing and, before all others are drawn, brings them to their places."""
    from matplotlib.artist import Artist

    class Mover(Artist):
        def draw(self, renderer: Any) -> None:
            move()
            self.stale = False

    mover = Mover()
    mover.set_zorder(BEHIND)
    return mover
