"""Laws of the field that measure angles, areas or ratios at the corners of triangles, as a script computes them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formation.laws.bisector import BisectorLaw
from formation.laws.triangles import TriangleSum
from formation.plane import Complex, as_complex
from scenarios.definition.experiment import Experiment
from scenarios.export.listing import LawText, Rows, corners, edges, saying


def _rays(experiment: Experiment, triples: Rows) -> tuple[Complex, Complex]:
    at, first, second = as_complex(experiment.formation.positions)[triples.T]
    return first - at, second - at


def _of_followers(experiment: Experiment) -> Rows:
    """(n - 2, 3) each follower and the two agents that it measures."""
    pairs = experiment.graph.edges[experiment.graph.corners]  # (n - 2, 2, 2)
    return np.column_stack([pairs[:, 0, 0], pairs[..., 1]])


DISTANCE = """\
    e = p[AGENT] - p[MEASURED]
    np.add.at(u, AGENT, (WANTED**2 - abs(e) ** 2) * e)
"""

RAYS = "    a, b = p[FIRST] - p[CORNER], p[SECOND] - p[CORNER]\n"

AREA = RAYS + "    error = (a.conj() * b).imag - SOUGHT[0]\n    np.add.at(u, CORNER, -{gain} * error * 1j * (b - a))\n"


def _area(experiment: Experiment) -> LawText:
    law = experiment.law
    triples = law.corners if isinstance(law, TriangleSum) else _of_followers(experiment)
    a, b = _rays(experiment, triples)
    tables, indices = edges(experiment, experiment.graph.edges, "their distance in the target (m)", abs)
    more = corners(experiment, triples, "the cross product (m^2)", [[x] for x in (np.conj(a) * b).imag])
    gain = float(experiment.scenario.law.parameters.get("gain", 1.0))
    return LawText(saying(experiment), f"{tables}\n{more[0]}", indices + more[1], DISTANCE + AREA.format(gain=gain))


SLOPE = '''

def slope(x, y):
    """The derivative of the cosine between x and y by x."""
    u, v = x / abs(x), y / abs(y)
    return (v - u * (u.conj() * v).real) / abs(x)
'''

COSINE = (
    RAYS
    + """\
    error = (a.conj() * b).real / abs(a * b) - SOUGHT[0]
    np.add.at(u, CORNER, error * (slope(a, b) + slope(b, a)))
    np.add.at(u, FIRST, -error * slope(a, b))
    np.add.at(u, SECOND, -error * slope(b, a))
"""
)


def _cosines(experiment: Experiment, triples: Rows) -> tuple[str, str]:
    a, b = _rays(experiment, triples)
    cosines = (np.conj(a) * b).real / np.abs(a * b)
    return corners(experiment, triples, "the cosine of the angle", [[each] for each in cosines])


def _cosine(experiment: Experiment) -> LawText:
    law = experiment.law
    triples = law.corners if isinstance(law, TriangleSum) else np.empty((0, 3), dtype=np.intp)
    return LawText(saying(experiment), *_cosines(experiment, triples), COSINE, SLOPE)


def _mixed(experiment: Experiment) -> LawText:
    pairs = experiment.graph.edges
    tables, indices = edges(experiment, pairs[(pairs == 0).any(axis=1)], "their distance in the target (m)", abs)
    more = _cosines(experiment, np.array([[0, 1, 2]]))
    return LawText(saying(experiment), f"{tables}\n{more[0]}", indices + more[1], DISTANCE + COSINE, SLOPE)


ANGLE = (
    RAYS
    + """\
    a, b = a / abs(a), b / abs(b)
    error = {measured} - SOUGHT[0]
    np.add.at(u, CORNER, -{error} * (a + b))
"""
)


def _bisector(experiment: Experiment) -> LawText:
    law = experiment.law
    triples = law.corners if isinstance(law, BisectorLaw) else np.empty((0, 3), dtype=np.intp)
    a, b = _rays(experiment, triples)
    listed = corners(experiment, triples, "the angle (rad)", [[each] for each in np.angle(b * np.conj(a))])
    wrapped = bool(experiment.scenario.law.parameters.get("wrapped", 0.0))
    error = "np.angle(np.exp(1j * error))" if wrapped else "error"
    measured = "np.angle(b * a.conj()) % (2 * np.pi)"
    return LawText(saying(experiment), *listed, ANGLE.format(measured=measured, error=error))


def _angles_alone(experiment: Experiment) -> LawText:
    triples = np.array([[0, 1, 2], [1, 0, 2], [2, 0, 1]])
    a, b = _rays(experiment, triples)
    listed = corners(experiment, triples, "the angle (rad)", [[abs(each)] for each in np.angle(b * np.conj(a))])
    return LawText(saying(experiment), *listed, ANGLE.format(measured="abs(np.angle(b * a.conj()))", error="error"))


RATIO = RAYS + "    u[CORNER] = {speed} * ((1 - SOUGHT[0]) * a + SOUGHT[0] * b) / (abs(a) + abs(b))\n"


def _ratio(experiment: Experiment) -> LawText:
    triples = _of_followers(experiment)
    a, b = _rays(experiment, triples)
    listed = corners(experiment, triples, "w (1), where it belongs", [[each] for each in -a / (b - a)])
    speed = float(experiment.scenario.law.parameters.get("speed", 0.5))
    return LawText(saying(experiment), *listed, RATIO.format(speed=speed))


CROSSING = (
    """\
    e = p[0] - p[1]
    u[1] = e * (1 - APART / abs(e))
"""
    + RAYS
    + """\
    length = abs(b - a)
    unit = (b - a) / length
    along = (SOUGHT[0] ** 2 - SOUGHT[1] ** 2 + length**2) / (2 * length)
    across = np.sqrt(np.maximum(SOUGHT[0] ** 2 - along**2, 0))
    foot = a + along * unit
    side = np.where(((1j * unit).conj() * foot).real > 0, -1, 1)
    u[CORNER] = foot + side * across * 1j * unit
"""
)


def _persistent(experiment: Experiment) -> LawText:
    triples = _of_followers(experiment)
    listed, indices = corners(
        experiment, triples, "its distances (m)", np.abs(np.array(_rays(experiment, triples)).T).tolist()
    )
    leader, first = as_complex(experiment.formation.positions)[:2]
    apart = f"APART = {float(abs(first - leader))!r}  # m, of the first follower from the leader\n"
    return LawText(saying(experiment), f"{listed}{apart}", indices, CROSSING)


CORNER_LAWS: dict[str, Callable[[Experiment], LawText]] = {
    "area": _area,
    "area-undirected": _area,
    "cosine": _cosine,
    "bisector": _bisector,
    "triangle-angles": _angles_alone,
    "triangle-mixed": _mixed,
    "ratio": _ratio,
    "persistent": _persistent,
}
"""By the names that scenarios use."""
