"""What every law of the catalogue must be: what it declares, and nothing else; gradients are gradients."""

from collections.abc import Callable

import numpy as np
import pytest

from formation import LAWS, Framework, Law, SensingGraph, TargetFormation, agents, needs, random_target
from formation.audit import Subject, audit
from formation.constraint import constraint_coefficients, interior_angles
from formation.graph.designs import design
from formation.graph.edges import triangles
from formation.graph.rigidity import undirected_pairs
from formation.measurements import KINDS
from formation.plane import as_complex

DEMANDED = ("output", "same answer again", "locality", "graph", "measurements", "compass", "local frames",
            "mirrored frames", "rest at the target")  # fmt: skip
"""Checks of the audit that hold a law against what it declares, and that every law must pass."""

PAPER = TargetFormation(
    SensingGraph(agents.rows([[1, 2], [2, 3], [1, 4], [1, 4]])),
    np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]]),
)


def made(name: str, seed: int | None = None) -> tuple[Law, Framework]:
    """The law on its own kind of graph, for the paper's target or a random one; for three agents where it must be."""
    n = 3 if LAWS[name].graph == "triangle" else 6
    target = PAPER if seed is None and n == 6 else random_target(n, np.random.default_rng(seed), np.radians(20.0))
    formation = design(LAWS[name].graph, target)
    law = LAWS[name](formation)  # type: ignore[call-arg]
    return law, formation


def at(law: Law, formation: Framework, points: np.ndarray) -> np.ndarray:
    return Subject(law, formation)(points)


@pytest.mark.parametrize("name", LAWS)
def test_what_a_law_declares_is_what_the_audit_finds(name: str) -> None:
    law, formation = made(name)
    found = {finding.check: finding for finding in audit(Subject(law, formation), 1e-6)}
    assert {check for check in DEMANDED if found[check].holds is not True} == set(), found
    assert found["batches"].remark.startswith("taken"), found["batches"]


@pytest.mark.parametrize("name", LAWS)
def test_a_law_that_declares_too_little_or_too_much_is_found_out(name: str) -> None:
    law, formation = made(name)

    class Boasting:
        """The same law with another word about mirrored frames."""

        needs_compass = law.needs_compass
        needs_handedness = not law.needs_handedness
        measures, graph = law.measures, law.graph

        def __call__(self, *arguments: np.ndarray) -> np.ndarray:
            return law(*arguments)

    found = {finding.check: finding for finding in audit(Subject(Boasting(), formation), 1e-6)}
    assert found["mirrored frames"].holds is False


@pytest.mark.parametrize("name", LAWS)
def test_a_law_declares_kinds_and_conditions_that_exist_and_a_name_that_files_use(name: str) -> None:
    declared = needs(made(name)[0])
    assert set(declared.measures) <= set(KINDS)
    assert LAWS[name].name == name
    assert LAWS[name].__module__.startswith("formation.laws.")


def difference(potential: Callable[[np.ndarray], float], points: np.ndarray, h: float = 1e-6) -> np.ndarray:
    """Minus the gradient of a potential by central differences."""
    slope = np.zeros_like(points)
    for index in np.ndindex(points.shape):
        move = np.zeros_like(points)
        move[index] = h
        slope[index] = (potential(points + move) - potential(points - move)) / (2.0 * h)
    return -slope


def distances(formation: Framework, points: np.ndarray) -> float:
    i, j = undirected_pairs(formation.graph.edges).T
    square = [((p[i] - p[j]) ** 2).sum(axis=1) for p in (points, formation.positions)]
    return float(((square[0] - square[1]) ** 2).sum() / 4.0)


def areas(formation: Framework, points: np.ndarray) -> float:
    def signed(p: np.ndarray) -> np.ndarray:
        i, j, k = as_complex(p)[triangles(formation.graph.edges)].T
        return (np.conj(j - i) * (k - i)).imag

    return distances(formation, points) + float(((signed(points) - signed(formation.positions)) ** 2).sum() / 2.0)


def cosines(formation: Framework, points: np.ndarray) -> float:
    def at_corners(p: np.ndarray) -> np.ndarray:
        corners = triangles(formation.graph.edges)[:, [[0, 1, 2], [1, 2, 0], [2, 0, 1]]].reshape(-1, 3)
        h, a, b = (p[c] for c in corners.T)
        return ((a - h) * (b - h)).sum(1) / np.linalg.norm(a - h, axis=1) / np.linalg.norm(b - h, axis=1)

    return float(((at_corners(points) - at_corners(formation.positions)) ** 2).sum() / 2.0)


def residuals(formation: Framework, points: np.ndarray) -> float:
    corners = triangles(formation.graph.edges)
    coefficients = constraint_coefficients(interior_angles(*(formation.positions[c] for c in corners.T)))
    return float((np.abs((coefficients * as_complex(points)[corners]).sum(axis=1)) ** 2).sum() / 2.0)


def mixed(formation: Framework, points: np.ndarray) -> float:
    def parts(p: np.ndarray) -> tuple[np.ndarray, float]:
        a, b = p[1] - p[0], p[2] - p[0]
        return np.array([a @ a, b @ b]), a @ b / np.linalg.norm(a) / np.linalg.norm(b)

    (square, cosine), (wanted, wanted_cosine) = parts(points), parts(formation.positions)
    return float(((square - wanted) ** 2).sum() / 4.0 + (cosine - wanted_cosine) ** 2 / 2.0)


@pytest.mark.parametrize(
    ("name", "potential"),
    [
        ("distance-undirected", distances),
        ("area-undirected", areas),
        ("cosine", cosines),
        ("triangular", residuals),
        ("triangle-mixed", mixed),
    ],
)
@pytest.mark.parametrize("seed", range(3))
def test_a_gradient_law_is_the_gradient_of_its_potential(
    name: str, potential: Callable[[Framework, np.ndarray], float], seed: int
) -> None:
    law, formation = made(name, seed)
    points = np.random.default_rng(seed).normal(size=(formation.graph.n, 2))
    found = difference(lambda p: potential(formation, p), points)
    np.testing.assert_allclose(at(law, formation, points), found, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("gain", [0.5, 3.0])
def test_the_directed_area_law_is_each_followers_own_gradient(gain: float) -> None:
    formation = random_target(5, np.random.default_rng(1))
    law, points = LAWS["area"](formation, gain=gain), np.random.default_rng(2).normal(size=(5, 2))  # type: ignore[call-arg]
    u = at(law, formation, points)
    for k, (i, j) in enumerate(formation.graph.neighbours.tolist(), start=2):

        def potential(place: np.ndarray, k: int = k, i: int = i, j: int = j) -> float:
            def parts(p_k: np.ndarray, p: np.ndarray) -> np.ndarray:
                square = [((p_k - p[m]) ** 2).sum() for m in (i, j)]
                (ax, ay), (bx, by) = p[j] - p[i], p_k - p[i]
                return np.array([*square, ax * by - ay * bx])

            error = parts(place[0], points) - parts(formation.positions[k], formation.positions)
            return float((error[:2] ** 2).sum() / 4.0 + gain * error[2] ** 2 / 2.0)

        np.testing.assert_allclose(u[k], difference(potential, points[k][None])[0], rtol=1e-5, atol=1e-6)
    assert not u[0].any()
