"""What every law of a script lists: its agents, the edges that they measure, the corners of their triangles."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation.plane import as_complex
from scenarios.definition.experiment import Experiment
from scenarios.export.wording import number, table

Rows = NDArray[np.intp]


@dataclass(frozen=True)
class LawText:
    """A law in a script.

    Attributes:
        saying: of the introduction: what the law does.
        tables: its lists, with what they hold.
        indices: arrays that are made of them.
        body: lines that add to the velocities ``u`` of points ``p``.
        functions: what these lines call.
    """

    saying: str
    tables: str
    indices: str
    body: str
    functions: str = ""


def renumbered(experiment: Experiment) -> bool:
    """Whether agents have numbers of their own."""
    return experiment.numbers != tuple(range(1, experiment.n + 1))


def rows_by_number(experiment: Experiment) -> str:
    """The line that finds agents by their numbers; nothing where numbers are rows."""
    return "ROW = {agent: row for row, agent in enumerate(AGENTS)}\n" if renumbered(experiment) else ""


def picked(experiment: Experiment, names: str, listed: str, columns: str) -> str:
    """A line that makes rows of the agents in the ``columns`` of each tuple of a list, such as ``EDGES``."""
    each = listed[:-1].lower()
    if renumbered(experiment):
        return f"{names} = np.array([[ROW[k] for k in {each}[{columns}]] for {each} in {listed}]).T\n"
    return f"{names} = np.array([{each}[{columns}] for {each} in {listed}]).T - 1\n"


def edges(experiment: Experiment, pairs: Rows, what: str, value: Callable[[complex], complex]) -> tuple[str, str]:
    """A list of edges (m, 2), with the ``value`` of each edge's place in the target; and the arrays made of it."""
    places = as_complex(experiment.formation.positions)
    rows = [
        (repr(experiment.number(k)), repr(experiment.number(i)), number(complex(value(complex(places[k] - places[i])))))
        for k, i in pairs.tolist()
    ]
    return (
        f"# Agent, agent that it measures, and {what}.\nEDGES = [\n{table(rows)}\n]\n",
        picked(experiment, "AGENT, MEASURED", "EDGES", ":2") + "WANTED = np.array([edge[2] for edge in EDGES])\n",
    )


def corners(experiment: Experiment, triples: Rows, what: str, values: Sequence[Sequence[complex]]) -> tuple[str, str]:
    """A list of corners (m, 3), each an agent and two others, and what the law wants there; and the arrays of it."""
    rows = [
        [repr(experiment.number(row)) for row in corner] + [number(complex(value)) for value in wanted]
        for corner, wanted in zip(triples.tolist(), values, strict=True)
    ]
    return (
        f"# Agent, the two agents between which it measures, and {what}.\nCORNERS = [\n{table(rows)}\n]\n",
        picked(experiment, "CORNER, FIRST, SECOND", "CORNERS", ":3")
        + "SOUGHT = np.array([corner[3:] for corner in CORNERS]).T\n",
    )


def saying(experiment: Experiment) -> str:
    """The first line of the law's own page."""
    return (sys.modules[type(experiment.law).__module__].__doc__ or "").partition("\n")[0]
