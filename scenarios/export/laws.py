"""The laws as a script computes them: tables of who measures whom, and lines that make velocities of points.

Points are complex. A linear law is what it makes of each edge; those of the field that are not are written out in the
words of :mod:`formation.laws`, and tests hold every one against the law itself.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formation import AngleLaw, agents
from formation.laws.feedforward import shares
from formation.plane import as_complex
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError, did_you_mean
from scenarios.export import pieces
from scenarios.export.corner_laws import CORNER_LAWS, DISTANCE
from scenarios.export.course import distinct_shapes, steered
from scenarios.export.listing import LawText, edges, picked, renumbered, saying
from scenarios.export.wording import number, table

LINEAR = ("affine", "affine-undirected", "laplacian", "redundant", "triangular")
"""Laws that add up constant complex multiples of what they measure."""


def law_text(experiment: Experiment) -> LawText:
    """The law of an experiment.

    Raises:
        InputError: a script cannot carry it.
    """
    name, path = experiment.scenario.law.name, experiment.file.path
    if experiment.scenario.law.without_neighbour == "another-pair":
        raise InputError(f'{path}: law.without_neighbour: a script for the testbed has one pair, got "another-pair"')
    if isinstance(experiment.law, AngleLaw):
        return _angle(experiment)
    if name in LINEAR:
        return _linear(experiment)
    if name not in WRITTEN:
        known = ("angle", *LINEAR, *WRITTEN)
        raise InputError(f"{path}: law.name: a script for the testbed cannot carry it, {did_you_mean(name, known)}")
    return WRITTEN[name](experiment)


def gain_rows(experiment: Experiment) -> list[tuple[str, str, str]]:
    """Follower, agent that it measures, and gain, of the angle law."""
    law = experiment.law
    observer, observed = (column[1:].tolist() for column in experiment.graph.edges.T)
    gains = law.gains.ravel().tolist() if isinstance(law, AngleLaw) else []
    return [
        (repr(experiment.number(k)), repr(experiment.number(i)), number(gain))
        for k, i, gain in zip(observer, observed, gains, strict=True)
    ]


ADDED = "    np.add.at(u, FOLLOWER, GAIN * (p[MEASURED] - p[FOLLOWER]))\n"

PAPER = (
    "Every follower measures the relative positions of two others and steers the angles of their triangle to those of "
    'the target: Li, Shen, Jing, Song, "Angle-Constrained Formation Control under Directed Non-Triangulated Sensing '
    'Graphs", Automatica.'
)


def _angle(experiment: Experiment) -> LawText:
    tables, indices, body = _changing(experiment) if experiment.shapes else _unchanging(experiment)
    if steered(experiment):
        first = experiment.number(agents.FIRST_FOLLOWER)
        body += pieces.FIRST_FOLLOWER[experiment.first_follower].format(number=first)
    if experiment.scenario.law.feedforward:
        tables, indices, body = f"{tables}\n{_shares(experiment)}", indices + _fed(experiment), body + pieces.FED
    return LawText(PAPER, tables, indices, body)


def _unchanging(experiment: Experiment) -> tuple[str, str, str]:
    return (
        "# Follower, agent that it measures, and the law's gain (1/s), eq. (u).\n"
        f"EDGES = [\n{table(gain_rows(experiment))}\n]\n",
        picked(experiment, "FOLLOWER, MEASURED", "EDGES", ":2") + "GAIN = np.array([edge[2] for edge in EDGES])\n",
        ADDED,
    )


def _changing(experiment: Experiment) -> tuple[str, str, str]:
    lists = "\n".join(f"    [\n{table(gain_rows(each), 8)}\n    ]," for each in distinct_shapes(experiment))
    row = "ROW[{}]" if renumbered(experiment) else "{} - 1"
    return (
        "# Of each shape: follower, agent that it measures, and the law's gain (1/s),\n# eq. (u).\n"
        f"SHAPES = [\n{lists}\n]\n",
        pieces.CHANGING_GAINS.format(follower=row.format("follower"), measured=row.format("measured")),
        "    u += GAINS[shape] @ p\n",
    )


def _shares(experiment: Experiment) -> str:
    """The feed-forward of each follower, and of the first one, to which all of the distance belongs."""
    first = (agents.FIRST_FOLLOWER, agents.LEADER, agents.FIRST_FOLLOWER)
    triples = [first, *((k, i, j) for i, j, k in experiment.target.graph.triangles.tolist())]
    values = [1.0, *shares(experiment.target).tolist()]
    rows = [
        (*(repr(experiment.number(row)) for row in triple), number(complex(value)))
        for triple, value in zip(triples, values, strict=True)
    ]
    return pieces.FEEDFORWARD.format(rows=table(rows))


def _fed(experiment: Experiment) -> str:
    return picked(experiment, "FED, FED_FROM, FED_TO", "SHARES", ":3") + (
        "SHARE = np.array([share[3] for share in SHARES])\n"
    )


def _linear(experiment: Experiment) -> LawText:
    pairs = experiment.graph.edges
    one_by_one = np.zeros((len(pairs), len(pairs), 2))
    one_by_one[..., 0] = np.eye(len(pairs))
    made = as_complex(experiment.law(one_by_one, None, None))[np.arange(len(pairs)), pairs[:, 0]]
    rows = [
        (repr(experiment.number(k)), repr(experiment.number(i)), number(complex(gain)))
        for (k, i), gain in zip(pairs.tolist(), made.tolist(), strict=True)
        if gain != 0.0
    ]
    return LawText(
        saying(experiment),
        f"# Agent, agent that it measures, and the law's gain (1/s).\nEDGES = [\n{table(rows)}\n]\n",
        picked(experiment, "FOLLOWER, MEASURED", "EDGES", ":2") + "GAIN = np.array([edge[2] for edge in EDGES])\n",
        ADDED,
    )


def _edge_sum(what: str, value: Callable[[complex], complex], lines: str) -> Callable[[Experiment], LawText]:
    """A law that adds up what it makes of each edge, from the edge's value in the target."""

    def text(experiment: Experiment) -> LawText:
        tables, indices = edges(experiment, experiment.graph.edges, what, value)
        return LawText(saying(experiment), tables, indices, lines)

    return text


_DISPLACEMENT = _edge_sum(
    "where it should be from there (m)",
    lambda e: e,
    "    np.add.at(u, AGENT, WANTED - (p[AGENT] - p[MEASURED]))\n",
)
_DISTANCE = _edge_sum("their distance in the target (m)", abs, DISTANCE)
_BEARING = _edge_sum(
    "in which direction it should be",
    lambda e: e / abs(e),
    """\
    b = p[AGENT] - p[MEASURED]
    b /= abs(b)
    np.add.at(u, AGENT, WANTED - b * (b.conj() * WANTED).real)
""",
)

WRITTEN: dict[str, Callable[[Experiment], LawText]] = {
    "displacement": _DISPLACEMENT,
    "displacement-undirected": _DISPLACEMENT,
    "distance": _DISTANCE,
    "distance-undirected": _DISTANCE,
    "bearing": _BEARING,
    "bearing-undirected": _BEARING,
    **CORNER_LAWS,
}
"""The laws that are not linear, by the names that scenarios use."""
