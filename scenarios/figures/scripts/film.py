"""The film of a script's run: robots and their paths on the floor."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from robots.model import GTERNAL
from scenarios.figures.films.encode import OnFrame, write_film
from scenarios.figures.films.film import Pixels
from scenarios.figures.films.layout import Frame, even, layout
from scenarios.figures.floor import limits, placed, prepare, wedge
from scenarios.figures.palette import agent_colour
from scenarios.figures.scripts.overview import FLOOR
from scenarios.figures.style import panel
from scenarios.storage.script_folder import ScriptRun


def animate_script(run: ScriptRun, path: Path, speed: float, fps: float, frame: Frame, on_frame: OnFrame) -> None:
    """Write the film of a run as ``path``; see :func:`scenarios.figures.films.encode.write_film`."""
    write_film(lambda: ScriptFilm(run, speed, fps, frame), float(run.record.t[-1]), path, speed, fps, frame, on_frame)


class ScriptFilm:
    """The frames of a run: robots and their paths on the floor. See :class:`scenarios.figures.films.film.Film`."""

    def __init__(self, run: ScriptRun, speed: float, fps: float, frame: Frame) -> None:
        self._record = run.record
        t = run.record.t
        self.rows = np.append(np.searchsorted((t[1:] + t[:-1]) / 2.0, np.arange(t[0], t[-1], speed / fps)), len(t) - 1)
        shown = limits(FLOOR, run.record.poses)
        places = layout(frame, shown, curve=False)
        self._figure = Figure(figsize=places.size, dpi=places.dots_per_inch)
        self._canvas = FigureCanvasAgg(self._figure)
        self.size = even(self._canvas.get_width_height())
        self._floor = panel(self._figure, *places.floor)
        prepare(self._floor, FLOOR, shown)
        self._floor.set_title(f"{run.result['script']}, {run.result['plant']}, {speed:g} x", loc="left", pad=4.0)
        colours = [agent_colour(robot) for robot in range(run.record.poses.shape[1])]
        self._trails = LineCollection([], colors=colours, linewidths=0.9, alpha=0.75)
        self._bodies = PolyCollection([], facecolors=colours, edgecolors="white", linewidths=0.3)
        self._noses = PolyCollection([], facecolors="white", linewidths=0.0)
        self._clock = self._floor.annotate(
            "", (1.0, 1.0), xycoords="axes fraction", xytext=(0.0, 4.0), textcoords="offset points", ha="right"
        )
        for artist in (self._trails, self._bodies, self._noses):
            self._floor.add_artist(artist)
        for moving in (self._trails, self._bodies, self._noses, self._clock):
            moving.set_animated(True)

    def frames(self) -> Iterator[Pixels]:
        """Each frame in turn as (height, width, 4) RGBA; the array is overwritten by the next frame."""
        self._canvas.draw()
        still = self._canvas.copy_from_bbox(self._figure.bbox)
        before = int(self.rows[0])
        for row in self.rows.tolist():
            self._canvas.restore_region(still)
            self._trail(before, row)
            still = self._canvas.copy_from_bbox(self._figure.bbox)
            before = row
            yield self._drawn(row)

    def last(self) -> Pixels:
        """The last frame with whole paths, as (height, width, 4) RGBA."""
        self._canvas.draw()
        end = int(self.rows[-1])
        self._trail(0, end)
        return self._drawn(end).copy()

    def _trail(self, before: int, row: int) -> None:
        self._trails.set_segments(list(np.moveaxis(self._record.poses[before : row + 1, :, :2], 1, 0)))
        self._floor.draw_artist(self._trails)

    def _drawn(self, row: int) -> Pixels:
        poses = self._record.poses[row]
        self._bodies.set_verts(list(placed(GTERNAL.chassis.outline, poses)))
        self._noses.set_verts(list(placed(wedge(GTERNAL.chassis), poses)))
        self._clock.set_text(f"{self._record.t[row]:.1f} s")
        for artist in (self._bodies, self._noses, self._clock):
            self._floor.draw_artist(artist)
        width, height = self.size
        return np.asarray(self._canvas.buffer_rgba())[:height, :width]
