"""A film of a run: robots on the floor, above the sum of their angle errors.

What stands still is drawn once. Each frame adds the new piece of every trail to that picture, copies it, and draws the
few artists that move; so the cost of a frame does not grow with the film.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from scenarios.definition.experiment import Experiment
from scenarios.figures.films.layout import Frame, even, layout
from scenarios.figures.floor import limits, placed, prepare, wedges
from scenarios.figures.happenings import draw_passing, lasting, mark_times, news
from scenarios.figures.palette import FAINT, INK, agent_colour
from scenarios.figures.style import SMALL, panel
from scenarios.figures.timelines import MANY, draw_error_sum, mark_phases
from scenarios.measures.metrics import Metrics
from scenarios.measures.tracking import reference
from scenarios.simulation.outages import lost_edges
from scenarios.simulation.trajectory import Trajectory

Pixels = NDArray[np.uint8]


class Film:
    """The frames of a run.

    Args:
        experiment, trajectory, metrics: of the run; states that are not finite are left out.
        speed: simulated seconds per second of film.
        fps: frames per second.
        frame: its pixels, of which an odd number loses one.

    Attributes:
        rows: (f,) rows of the trajectory, one per frame: the states nearest to the frames' times, the last included.
        floor: the axes on which the robots move.
        size: (width, height) of a frame, pixels, both even as video codecs want them.
    """

    def __init__(
        self,
        experiment: Experiment,
        trajectory: Trajectory,
        metrics: Metrics,
        speed: float,
        fps: float,
        frame: Frame,
    ) -> None:
        self._experiment, self._trajectory = experiment, trajectory
        self.rows = frame_rows(trajectory, speed, fps)
        shown = limits(experiment.arena, trajectory.poses)
        places = layout(frame, shown)
        self._figure = Figure(figsize=places.size, dpi=places.dots_per_inch)
        self._canvas = FigureCanvasAgg(self._figure)
        self.size = even(self._canvas.get_width_height())
        self.floor = panel(self._figure, *places.floor)
        prepare(self.floor, lasting(experiment), shown)
        self._passing = draw_passing(self.floor, experiment)
        crosses = ";  + predicted places" if experiment.predicted else ""
        self.floor.set_title(f"{experiment.file.name}, {experiment.plant}, {speed:g} x{crosses}", loc="left", pad=4.0)
        self._errors = panel(self._figure, *places.errors)
        draw_error_sum(self._errors, experiment, trajectory, metrics)
        self._errors.set_xlabel("time (s)")
        mark_phases(self._errors, experiment, names=True)
        mark_times(self._errors, experiment, numbers=True)
        self._predicted = reference(experiment, trajectory) if experiment.predicted else None
        self._outlines, self._wedges = experiment.fleet.outlines, wedges(experiment.fleet)
        self._make_movers()

    def frames(self) -> Iterator[Pixels]:
        """Each frame in turn as (height, width, 4) RGBA; the array is overwritten by the next frame."""
        self._canvas.draw()
        still = self._canvas.copy_from_bbox(self._figure.bbox)
        width, height = self.size
        before = int(self.rows[0])
        for row in self.rows.tolist():
            self._canvas.restore_region(still)
            self._trails.set_segments(list(np.moveaxis(self._trajectory.points[before : row + 1], 1, 0)))
            self.floor.draw_artist(self._trails)
            still = self._canvas.copy_from_bbox(self._figure.bbox)
            self._move(row)
            before = row
            yield np.asarray(self._canvas.buffer_rgba())[:height, :width]

    def last(self) -> Pixels:
        """The last frame with whole trails, as (height, width, 4) RGBA."""
        self._canvas.draw()
        end = int(self.rows[-1])
        self._trails.set_segments(list(np.moveaxis(self._trajectory.points[: end + 1], 1, 0)))
        self.floor.draw_artist(self._trails)
        self._move(end)
        width, height = self.size
        return np.array(self._canvas.buffer_rgba())[:height, :width]

    def _make_movers(self) -> None:
        n = self._experiment.n
        colours = [agent_colour(row) for row in range(n)]
        self._trails = LineCollection([], colors=colours, linewidths=0.9, alpha=0.75)
        self._edges = LineCollection([], colors=FAINT, linewidths=0.6)
        self._ghosts = Line2D([], [], linestyle="", marker="+", markersize=5.0, markeredgewidth=0.7, color=INK)
        self._bodies = PolyCollection([], facecolors=colours, edgecolors="white", linewidths=0.3)
        self._noses = PolyCollection([], facecolors="white", linewidths=0.0)
        self._dots = Line2D([], [], linestyle="", marker="o", markersize=4.0, color=INK)
        self._numbers = [
            self.floor.text(0.0, 0.0, str(self._experiment.number(row)), fontsize=SMALL, ha="left", va="bottom")
            for row in range(n if n <= MANY else 0)
        ]
        self._clock = self.floor.annotate(
            "", (1.0, 1.0), xycoords="axes fraction", xytext=(0.0, 4.0), textcoords="offset points", ha="right"
        )
        self._news = self.floor.text(
            0.01,
            0.985,
            "",
            transform=self.floor.transAxes,
            fontsize=SMALL,
            ha="left",
            va="top",
            zorder=8,
            bbox={"facecolor": "white", "alpha": 0.85, "linewidth": 0.0, "pad": 1.5},
        )
        self._cursor = self._errors.axvline(0.0, color=INK, linewidth=0.6)
        moving: list[Artist] = [self._edges, self._ghosts, self._bodies, self._noses, self._dots]
        for artist in (self._trails, *moving):
            self.floor.add_artist(artist)
        passing = [patch for _, patch in self._passing]
        for artist in (*passing, self._trails, *moving, *self._numbers, self._clock, self._news, self._cursor):
            artist.set_animated(True)

    def _move(self, row: int) -> None:
        """Draw what moves, as it is in a row of the trajectory."""
        points, poses = self._trajectory.points[row], self._trajectory.poses[row]
        fleet, t = self._experiment.fleet, float(self._trajectory.t[row])
        for event, patch in self._passing:
            if event.lasts(t):
                self.floor.draw_artist(patch)
        self._edges.set_segments(list(points[self._edges_at(row)]))
        if self._predicted is not None:
            self._ghosts.set_data(*self._predicted[row].T)
        if self._experiment.plant == "single_integrator":
            self._dots.set_data(*points.T)
        else:
            self._bodies.set_verts(list(placed(self._outlines, poses)))
            self._noses.set_verts(list(placed(self._wedges, poses)))
        for artist in (self._edges, self._ghosts, self._bodies, self._noses, self._dots):
            self.floor.draw_artist(artist)
        for number, point in zip(self._numbers, points + 0.6 * fleet.widest, strict=False):
            number.set_position((point[0], point[1]))
            self.floor.draw_artist(number)
        phases = self._experiment.phases
        phase = f"{phases[self._trajectory.phase[row]].name}, " if len(phases) > 1 else ""
        self._clock.set_text(f"{phase}{t:.1f} s")
        self.floor.draw_artist(self._clock)
        if self._experiment.events:
            self._news.set_text(news(self._experiment, t))
            self.floor.draw_artist(self._news)
        self._cursor.set_xdata([t, t])
        self._errors.draw_artist(self._cursor)

    def _edges_at(self, row: int) -> NDArray[np.intp]:
        """The formation graph's edges, without those that an event has taken."""
        index, t = int(self._trajectory.phase[row]), float(self._trajectory.t[row])
        graph = self._experiment.of_phase(index).graph
        edges = graph.formation_edges
        if not self._experiment.events:
            return edges
        sensed = len(graph.edges)
        keep = np.ones(len(edges), dtype=bool)
        keep[:sensed] = ~lost_edges(self._experiment, t, index)[:sensed]
        return edges[keep]


def frame_rows(trajectory: Trajectory, speed: float, fps: float) -> NDArray[np.intp]:
    """(f,) rows of the finite states nearest to the times 0, speed / fps, 2 speed / fps, ..., and the last one."""
    t = trajectory.t[np.isfinite(trajectory.poses).all(axis=(1, 2))]
    times = np.arange(t[0], t[-1], speed / fps)
    return np.append(np.searchsorted((t[1:] + t[:-1]) / 2.0, times), len(t) - 1)
