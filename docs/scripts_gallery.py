"""Draw the runs that docs/scripts_on_rps.py has kept side by side: docs/images/scripts-gallery.png.

.venv/bin/python docs/scripts_gallery.py runs/scripts-on-rps docs/images/scripts-gallery.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection

from robots import GTERNAL
from scenarios.figures.floor import placed
from scenarios.figures.palette import INK, agent_colour
from scenarios.figures.style import print_style, render, sheet
from scenarios.storage import script_folder

COLUMNS, WIDTH = 5, 7.0
"""Of panels; inches."""


def main() -> None:
    kept, out = Path(sys.argv[1]), Path(sys.argv[2])
    folders = sorted(path.parent for path in kept.rglob("pymunk/result.json"))
    rows = -(-len(folders) // COLUMNS)
    with print_style():
        each = WIDTH / COLUMNS
        figure = sheet(rows * (0.72 * each + 0.14), WIDTH)
        for number, folder in enumerate(folders):
            run = script_folder.read(folder)
            axes = figure.add_subplot(rows, COLUMNS, number + 1)
            for robot, path in enumerate(np.moveaxis(run.record.poses, 1, 0)):
                axes.plot(*path[:, :2].T, color=agent_colour(robot), linewidth=0.4, alpha=0.8)
            poses = run.record.poses[-1]
            colours = [agent_colour(robot) for robot in range(len(poses))]
            axes.add_collection(PolyCollection(list(placed(GTERNAL.chassis.outline, poses)), facecolors=colours))
            axes.set(xlim=(-1.65, 1.65), ylim=(-1.05, 1.05), aspect="equal", xticks=[], yticks=[])
            axes.add_patch(_floor())
            axes.set_title(
                f"{run.result['script']}, {run.result['duration_s']:.0f} s", fontsize=5.0, color=INK, pad=2.0
            )
            for side in axes.spines.values():
                side.set_visible(False)
        figure.subplots_adjust(left=0.005, right=0.995, bottom=0.005, top=0.96, wspace=0.03, hspace=0.16)
        out.write_bytes(render(figure, "png"))


def _floor() -> object:
    from matplotlib.patches import Rectangle

    return Rectangle((-1.6, -1.0), 3.2, 2.0, fill=False, edgecolor=INK, linewidth=0.6)


if __name__ == "__main__":
    main()
