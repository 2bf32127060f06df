"""The outline of a GTernal robot for matplotlib, as scripts for ``rps`` 2.1 use it.

Sizes in metres after S. Kim et al. 2024, "GTernal: A Robot Design for the Autonomous Operation of a Multi-robot
Research Testbed" (not checked against the text), as the public simulator draws them: 0.095 m long with a round front,
0.11 m wide between the middles of its wheels, the axle 0.016 m ahead of the back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Real = NDArray[np.float64]

LENGTH, WIDTH, WHEEL_RADIUS, WHEEL_WIDTH = 0.095, 0.11, 0.016, 0.008
"""Metres."""

LED_SIZE = 0.016
"""Metres of a side of the lamp."""

ARCH = 24
"""Points of the round front."""

GOLD, GREY, WHITE = (179 / 255, 163 / 255, 105 / 255), (0.2, 0.2, 0.2), (1.0, 1.0, 1.0)


@dataclass
class GTERNALPatchData:
    """What a robot is drawn from.

    Attributes:
        vertices: (V, 2) metres, in a frame whose y axis points ahead and whose origin is the axle's centre.
        faces: of the body, the left and the right wheel and the lamp: (k,) which vertices.
        colors: (4, 3) of the faces.
    """

    vertices: Real
    faces: list[NDArray[np.intp]]
    colors: Real


def gternal_patch() -> GTERNALPatchData:
    """The robot's faces, in its own frame."""
    half = (WIDTH - WHEEL_WIDTH) / 2.0
    shoulder = LENGTH - half - WHEEL_RADIUS
    turn = np.linspace(0.0, np.pi, ARCH)
    front = np.array([half * np.cos(turn), shoulder + half * np.sin(turn)]).T
    body = np.concatenate([[[-half, -WHEEL_RADIUS], [half, -WHEEL_RADIUS]], front])
    middle = half + WHEEL_WIDTH / 2.0
    wheel = _box(WHEEL_WIDTH, 2.0 * WHEEL_RADIUS)
    lamp = _box(LED_SIZE, LED_SIZE) + [0.56 * half, shoulder + half / 2.0]
    parts = [body, wheel - [middle, 0.0], wheel + [middle, 0.0], lamp]
    ends = np.cumsum([len(part) for part in parts])
    faces = [np.arange(end - len(part), end) for part, end in zip(parts, ends, strict=True)]
    return GTERNALPatchData(np.concatenate(parts), faces, np.array([GOLD, GREY, GREY, WHITE]))


class GTERNALRobotPatch:
    """The faces of one robot as matplotlib patches.

    Args:
        axes: where they are drawn.
        pose: (3,) x, y, theta, metres and radians.
        patch_data: of :func:`gternal_patch`, which is asked where it is absent.
    """

    LED_FACE_IDX = 3

    def __init__(self, axes: Axes, pose: ArrayLike, patch_data: GTERNALPatchData | None = None) -> None:
        from matplotlib.patches import Polygon

        self._data = gternal_patch() if patch_data is None else patch_data
        self._patches = [
            Polygon(self._placed(face, pose), facecolor=tuple(colour), edgecolor="none", zorder=2)
            for face, colour in zip(self._data.faces, self._data.colors, strict=True)
        ]
        for patch in self._patches:
            axes.add_patch(patch)

    def set_pose(self, pose: ArrayLike) -> None:
        """Move to (3,) x, y, theta."""
        for face, patch in zip(self._data.faces, self._patches, strict=True):
            patch.set_xy(self._placed(face, pose))

    def set_led(self, rgb: ArrayLike) -> None:
        """Light the lamp: red, green, blue, 0 to 255."""
        self._patches[self.LED_FACE_IDX].set_facecolor(tuple(np.asarray(rgb, dtype=np.float64) / 255.0))

    def set_zorder(self, zorder: float) -> None:
        """Draw above what has a lower order."""
        for patch in self._patches:
            patch.set_zorder(zorder)

    def _placed(self, face: NDArray[np.intp], pose: ArrayLike) -> Real:
        x, y, theta = np.asarray(pose, dtype=np.float64)
        c, s = np.cos(theta), np.sin(theta)
        return self._data.vertices[face] @ np.array([[s, -c], [c, s]]) + [x, y]


def _box(width: float, height: float) -> Real:
    x, y = width / 2.0, height / 2.0
    return np.array([[-x, y], [x, y], [x, -y], [-x, -y]])
