"""What an identified robot leaves unexplained in its log."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from robots.identification.estimate import Identified
from robots.identification.odometry import filled, odometry
from robots.model import GTERNAL
from scenarios.figures.palette import ALARM, INK
from scenarios.figures.style import COLUMN, SMALL, panel, sheet

Real = NDArray[np.float64]

_LEFT, _RIGHT = 0.46, 0.10
_AXES = ("x", "y", "heading")


def residuals(found: Identified) -> Figure:
    """Heading by the cameras less that by the encoders; whitened residuals over the turns and against the normal."""
    figure = sheet(3.6)
    numbers, log = found.numbers, found.log
    way = odometry(log, numbers.lag)
    theta, turns = filled(log.poses)[:, 2], np.arange(log.turns)
    rows = way.heard
    wide = COLUMN - _LEFT - _RIGHT
    top = panel(figure, _LEFT, 2.42, wide, 0.98)
    drive = GTERNAL.drive
    for base, radius, colour, label in (
        (drive.base_length, drive.wheel_radius, ALARM, f"data sheet, base {drive.base_length:g} m"),
        (numbers.base_length, numbers.wheel_radius, INK, f"identified, base {numbers.base_length:.4f} m"),
    ):
        off = theta - radius / base * way.turned
        top.plot(turns[rows], (off - off[0])[rows], color=colour, linewidth=0.6, label=label)
    top.set(ylabel="heading off (rad)", xlim=(0, log.turns))
    top.tick_params(labelbottom=False)
    figure.legend(loc="upper center", ncols=2, bbox_to_anchor=(0.5, 0.985))
    middle = panel(figure, _LEFT, 1.50, wide, 0.80)
    markers = (INK, "#7a8b99", ALARM)
    for i, colour in enumerate(markers):
        middle.plot(turns, found.residuals[:, i], ",", color=colour)
    middle.axhline(0.0, color=INK, linewidth=0.4)
    middle.set(ylabel="whitened", xlabel="turn of the log", xlim=(0, log.turns), ylim=(-6, 6))
    bottom = panel(figure, _LEFT, 0.34, wide, 0.78)
    normal = np.linspace(-3.5, 3.5, 2)
    bottom.plot(normal, normal, color=INK, linewidth=0.4)
    for i, (axis, colour) in enumerate(zip(_AXES, markers, strict=True)):
        values = np.sort(found.residuals[np.isfinite(found.residuals[:, i]), i])
        bottom.plot(_normal_quantiles(len(values)), values, color=colour, linewidth=0.9, label=axis)
    bottom.set(xlabel="quantile of the normal law", ylabel="residual", xlim=(-3.5, 3.5), ylim=(-6, 6))
    bottom.legend(loc="upper left", fontsize=SMALL, borderaxespad=0.5)
    return figure


def _normal_quantiles(count: int) -> Real:
    from scipy.special import ndtri

    return np.asarray(ndtri((np.arange(count) + 0.5) / count))
