"""The figure of a script's run: where its robots went, how close they came, how fast they were told to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.model import GTERNAL
from robots.rps.simulation import Record
from robots.testbed import COLLISION_DISTANCE, collision_centres, separation
from scenarios.figures.floor import limits, placed, prepare, wedge
from scenarios.figures.labels import Labels, points_per_metre
from scenarios.figures.palette import ALARM, INK, agent_colour
from scenarios.figures.style import COLUMN, SMALL, panel, print_style, render, sheet
from scenarios.storage.files import write_whole
from scenarios.storage.script_folder import ScriptRun

OVERVIEW = "figure-motion"
MANY = 12
"""Robots up to which each has its number."""

LEFT, RIGHT, BOTTOM, STRIP, GAP, TOP = 0.44, 0.11, 0.36, 0.55, 0.14, 0.2
"""Inches."""

FLOOR = Arena(ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y, walls=False)


def draw_overview(run: ScriptRun, folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write the overview of a run into ``folder``; the files."""
    paths = [folder / f"{OVERVIEW}.{form}" for form in formats]
    with print_style():
        figure = overview(run)
        for path, form in zip(paths, formats, strict=True):
            write_whole(path, render(figure, form))
    return paths


def overview(run: ScriptRun) -> Figure:
    """Start, end and paths on the floor; closest pair and wheel speeds over time."""
    record = run.record
    shown = limits(FLOOR, record.poses)
    width = COLUMN - LEFT - RIGHT
    height = min(3.2, width * (shown[3] - shown[2]) / (shown[1] - shown[0]))
    figure = sheet(BOTTOM + 2.0 * (STRIP + GAP) + 0.28 + height + TOP)
    floor = panel(figure, LEFT, BOTTOM + 2.0 * (STRIP + GAP) + 0.28, width, height)
    prepare(floor, FLOOR, shown)
    few = record.poses.shape[1] <= MANY
    for robot, path in enumerate(np.moveaxis(record.poses, 1, 0)):
        floor.plot(*path[:, :2].T, color=agent_colour(robot), linewidth=0.7 if few else 0.35, alpha=0.75, zorder=2)
    for poses, hollow in ((record.poses[0], True), (record.poses[-1], False)):
        colours = [agent_colour(robot) for robot in range(len(poses))]
        faces = ["white"] * len(poses) if hollow else colours
        outlines = list(placed(GTERNAL.chassis.outline, poses))
        floor.add_collection(PolyCollection(outlines, facecolors=faces, edgecolors=colours, linewidths=0.5, zorder=4))
        noses = list(placed(wedge(GTERNAL.chassis), poses))
        floor.add_collection(PolyCollection(noses, facecolors=colours if hollow else "white", linewidths=0.0, zorder=5))
    floor.set_title(f"{run.result['script']}, {run.result['plant']}: start hollow, end filled", loc="left")
    labels = Labels(floor, record.poses[:: max(1, len(record.t) // 200), :, :2].reshape(-1, 2))
    for robot in range(record.poses.shape[1] if few else 0):
        distance = 0.7 * GTERNAL.chassis.width * points_per_metre(floor) + 3.5
        labels.put(record.poses[-1, robot, :2], str(robot), distance, SMALL)
    wheels = panel(figure, LEFT, BOTTOM, width, STRIP)
    _wheels(wheels, record)
    near = panel(figure, LEFT, BOTTOM + STRIP + GAP, width, STRIP, sharex=wheels)
    _near(near, record)
    near.tick_params(labelbottom=False)
    wheels.set_xlabel("time (s)")
    figure.align_ylabels([near, wheels])
    return figure


def _near(axes: Axes, record: Record) -> None:
    distance = separation(collision_centres(record.poses)).distance
    if np.isfinite(distance).all():
        axes.plot(record.t, distance, color=INK, linewidth=0.9)
        axes.set_ylim(0.0, 1.1 * float(distance.max()))
        axes.fill_between(
            record.t, distance, COLLISION_DISTANCE, where=distance <= COLLISION_DISTANCE, color=ALARM, alpha=0.3,
            linewidth=0.0,
        )  # fmt: skip
    axes.axhline(COLLISION_DISTANCE, color=ALARM, linewidth=0.7, linestyle=(0, (4, 2)))
    axes.set_ylabel("closest (m)")


def _wheels(axes: Axes, record: Record) -> None:
    limit = float(GTERNAL.drive.wheel_speed_limit)
    for robot in range(record.poses.shape[1]):
        axes.plot(record.t[1:], record.wheel_speeds[1:, robot], color=agent_colour(robot), linewidth=0.4, alpha=0.7)
    for level in (-limit, limit):
        axes.axhline(level, color=ALARM, linewidth=0.7, linestyle=(0, (4, 2)))
    axes.set(ylabel="wheels (rad/s)", ylim=(-1.3 * limit, 1.3 * limit), xlim=(0.0, max(float(record.t[-1]), 0.033)))
