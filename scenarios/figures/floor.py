"""What stands and moves on the floor: the arena, robots as oriented bodies, edges and trails, in metres."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from formation import Graph
from robots import Arena, Chassis, Fleet
from scenarios.definition.experiment import Experiment
from scenarios.figures.palette import FAINT, INK, agent_colour
from scenarios.simulation.trajectory import Trajectory

Real = NDArray[np.float64]
Limits = tuple[float, float, float, float]
"""(x low, x high, y low, y high), metres."""

BEYOND = "#EDEDED"
"""Colour of the ground beyond the floor."""

OBSTACLE = "#BDBDBD"

HEAD = 0.07
"""Metres; the length of an arrow's head on an edge."""

MOST_DRAWN = 100_000
"""Places of all agents that trails go through."""

MARGIN = 0.05
"""Free ground around all that is shown, as a share of its longer side."""


def limits(arena: Arena, poses: Real) -> Limits:
    """The least that shows the whole floor and every finite pose (..., 3)."""
    places = poses[..., :2].reshape(-1, 2)
    shown = np.concatenate([arena.corners, places[np.isfinite(places).all(axis=1)]])
    margin = MARGIN * np.ptp(shown, axis=0).max()
    (x0, y0), (x1, y1) = shown.min(axis=0) - margin, shown.max(axis=0) + margin
    return float(x0), float(x1), float(y0), float(y1)


def prepare(axes: Axes, arena: Arena, shown: Limits) -> None:
    """Limits, labels with units, equal aspect, the floor and its obstacles."""
    x0, x1, y0, y1 = shown
    axes.set(
        xlim=(x0, x1), ylim=(y0, y1), xlabel="\U0001d465 (m)", ylabel="\U0001d466 (m)", aspect="equal", facecolor=BEYOND
    )
    corner, width, height = arena.corners[0], arena.x[1] - arena.x[0], arena.y[1] - arena.y[0]
    edge = 1.6 if arena.walls else 0.5
    axes.add_patch(Rectangle(tuple(corner), width, height, facecolor="white", edgecolor=INK, linewidth=edge, zorder=0))
    for obstacle in arena.obstacles:
        axes.add_patch(Polygon(obstacle.outline, facecolor=OBSTACLE, edgecolor=INK, linewidth=0.5, zorder=1))


def draw_trails(axes: Axes, trajectory: Trajectory, width: float = 0.7) -> None:
    """The path of each projected point, one line per agent in the order of the agents; of a crowd not every state."""
    steps, n = trajectory.points.shape[:2]
    stride = max(1, steps * n // MOST_DRAWN)
    for row in range(n):
        x, y = trajectory.points[::stride, row].T
        axes.plot(x, y, color=agent_colour(row), linewidth=width, alpha=0.75, zorder=2, label=f"trail {row}")


def draw_edges(axes: Axes, graph: Graph, points: Real, colour: str = FAINT) -> None:
    """The formation graph's edges between points (n, 2): sensed ones solid, the added ones dashed.

    Where they are sensed one way only, a head on each points to the agent that is sensed.
    """
    segments = points[graph.formation_edges]
    sensed = len(graph.edges)
    axes.add_collection(LineCollection(list(segments[:sensed]), colors=colour, linewidths=0.5, zorder=1))
    dashed = LineCollection(list(segments[sensed:]), colors=colour, linewidths=0.5, linestyles=[(0, (3, 2))], zorder=1)
    axes.add_collection(dashed)
    pairs = {(int(observer), int(observed)) for observer, observed in graph.edges}
    one_way = np.array([(observed, observer) not in pairs for observer, observed in graph.edges], dtype=bool)
    heads = _heads(points[graph.edges[one_way]])
    axes.add_collection(PolyCollection(list(heads), facecolors=colour, linewidths=0.0, zorder=1))


def _heads(segments: Real) -> Real:
    """(e, 3, 2) heads of arrows along segments (e, 2, 2), metres, a little beyond the middle, clear of the bodies."""
    way = segments[:, 1] - segments[:, 0]
    length = np.linalg.norm(way, axis=1, keepdims=True)
    along = way / np.maximum(length, 1e-12)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    head = np.minimum(HEAD, 0.3 * length)
    tip = segments[:, 0] + 0.62 * way
    back = tip - head * along
    return np.stack([tip, back + 0.3 * head * across, back - 0.3 * head * across], axis=1)


def draw_robots(axes: Axes, experiment: Experiment, poses: Real, points: Real, hollow: bool = False) -> None:
    """Robots at poses (n, 3): a chassis with a wedge that points ahead, white with a coloured outline if ``hollow``.

    A plant without bodies has dots at its points (n, 2).
    """
    colours = [to_rgb(agent_colour(row)) for row in range(len(poses))]
    face = [(1.0, 1.0, 1.0)] * len(poses) if hollow else colours
    if experiment.plant == "single_integrator":
        axes.scatter(points[:, 0], points[:, 1], s=12.0, facecolors=face, edgecolors=colours, linewidths=0.7, zorder=4)
        return
    fleet = experiment.fleet
    axes.add_collection(
        PolyCollection(
            list(placed(fleet.outlines, poses)), facecolors=face, edgecolors=colours, linewidths=0.5, zorder=4
        )
    )
    noses = list(placed(wedges(fleet), poses))
    axes.add_collection(PolyCollection(noses, facecolors=colours if hollow else "white", linewidths=0.0, zorder=5))


def wedge(chassis: Chassis) -> Real:
    """(3, 2) a triangle on the chassis that points ahead, metres, in the frame of the axle's centre."""
    back, front, side = -0.20 * chassis.length, 0.40 * chassis.length, 0.28 * chassis.width
    return np.array([[back, -side], [front, 0.0], [back, side]]) + [chassis.centre_offset, 0.0]


def wedges(fleet: Fleet) -> Real:
    """(n, 3, 2) the wedge of each robot."""
    return np.stack([wedge(body) for body in fleet.bodies])


def placed(outline: Real, poses: Real) -> Real:
    """(n, q, 2) outlines (q, 2) or (n, q, 2) in the robots' frames, moved to the poses (n, 3), metres."""
    cos, sin = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    x, y = outline[..., 0], outline[..., 1]
    turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
    return turned + poses[:, None, :2]
