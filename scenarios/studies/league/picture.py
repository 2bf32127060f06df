"""The league's figure: for each law, from the cloud of random starts to the shapes in which they end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from formation import Framework
from formation.plane import as_complex, as_vectors
from scenarios.storage.files import write_whole
from scenarios.studies.league.ends import ENDS, RIGHT, ends
from scenarios.studies.league.measure import Row

Real = NDArray[np.float64]

SHOWN = 60
"""Runs of each law that are drawn."""

CAPTION = "grey: random starts.  blue: ends in the right shape, with their share.  red: all other ends"


def draw(rows: Sequence[Row], path: Path) -> None:
    """Write the figure, a PNG: the ends, each turned and scaled to lie best on the target, in front of all starts."""
    from scenarios.figures.ensembles.shapes import Shapes, shapes  # matplotlib takes as long to load as a law to run

    panels = [
        Shapes(
            row.entry.name,
            f"{row.share:.0%}",
            row.starts[:SHOWN],
            overlaid(row.player.formation, row.flow.points[:SHOWN]),
            ends(row.player.formation, row.flow)[:SHOWN] == ENDS.index(RIGHT),
            np.unique(np.sort(row.player.formation.graph.edges, axis=1), axis=0),
        )
        for row in rows
        if row.player is not None and row.flow is not None and row.starts is not None
    ]
    write_whole(path, shapes(panels, CAPTION))


def overlaid(formation: Framework, points: Real) -> Real:
    """(runs, n, 2) configurations, metres, about their centres, turned and scaled to lie best on the target.

    An end that has no number, or no size, is drawn at the centre.
    """
    star = as_complex(formation.positions)
    star = star - star.mean()
    p = as_complex(np.nan_to_num(points, posinf=0.0, neginf=0.0))
    p = p - p.mean(axis=1, keepdims=True)
    spread = np.maximum((np.abs(p) ** 2).sum(axis=1), 1e-12)
    factor = (np.conj(p) @ star) / spread
    size = np.sqrt((np.abs(star) ** 2).sum() / spread)
    turn = np.where(np.abs(factor) > 0.0, factor / np.maximum(np.abs(factor), 1e-12), 1.0)
    return as_vectors(p * (turn * size)[:, None])
