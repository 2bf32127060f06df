"""The comparison laws reach what they claim to reach, and fail where theory says that they fail."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import LAWS, AngleSet, SensingGraph, TargetFormation, random_target
from formation.measurements import perfect
from formation.plane import as_complex, as_vectors

EQUILATERAL = TargetFormation(SensingGraph(np.array([[0, 1]])), np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]]))


def measured(family: str, target: TargetFormation, p: np.ndarray, frame: complex = 1.0) -> np.ndarray:
    """What the family's law measures at p, in frames that are all turned by the conjugate of ``frame``."""
    edges = target.graph.edges
    relative = as_vectors(as_complex(p[edges[:, 1]] - p[edges[:, 0]]) * frame)
    return perfect(LAWS[family].measures, relative, target.graph.corners)[0]


def run(family: str, target: TargetFormation, p: np.ndarray, duration: float = 60.0, h: float = 0.02) -> np.ndarray:
    law, compass = LAWS[family](target), np.tile([1.0, 0.0], (target.graph.n, 1))
    for _ in range(round(duration / h)):
        p = p + h * law(measured(family, target, p), compass)
    return p


@pytest.mark.parametrize("family", ["displacement", "bearing", "distance"])
@given(seed=st.integers(0, 2**32 - 1))
def test_the_target_is_an_equilibrium_and_the_leader_never_moves(family: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng)
    law, compass = LAWS[family](target), np.tile([1.0, 0.0], (6, 1))
    np.testing.assert_allclose(law(measured(family, target, target.positions), compass), 0.0, atol=1e-12)
    p = rng.normal(size=(6, 2))
    assert (law(measured(family, target, p), compass)[0] == 0.0).all()


def test_displacement_reaches_the_targets_scale_and_orientation() -> None:
    end = run("displacement", EQUILATERAL, np.array([[2.0, 1.0], [0.0, 0.0], [5.0, -1.0]]))
    np.testing.assert_allclose(end - end[0], EQUILATERAL.positions - EQUILATERAL.positions[0], atol=1e-9)


def test_bearing_reaches_the_targets_orientation_at_the_scale_of_the_first_two() -> None:
    end = run("bearing", EQUILATERAL, np.array([[2.0, 1.0], [1.0, 3.0], [5.0, -1.0]]), duration=200.0)
    assert np.linalg.norm(end[1] - end[0]) == pytest.approx(np.sqrt(5.0), rel=0.02)  # Euler steps stretch it a little
    angles = AngleSet.of_followers(EQUILATERAL.graph)
    errors = angles.errors(end, angles.measure(EQUILATERAL.positions))
    np.testing.assert_allclose(errors, 0.0, atol=1e-6)
    bearing = as_complex(end[1] - end[0]) / abs(as_complex(end[1] - end[0]))
    assert abs(bearing - 1.0) < 1e-6


def test_distance_keeps_a_mirrored_triangle_for_ever() -> None:
    end = run("distance", EQUILATERAL, np.array([[0.0, 0.0], [1.0, 0.0], [0.4, -1.2]]))
    np.testing.assert_allclose(end[2], [0.5, -np.sqrt(0.75)], atol=1e-6)
    angles = AngleSet.of_followers(EQUILATERAL.graph)
    assert np.abs(angles.errors(end, angles.measure(EQUILATERAL.positions))).min() > 1.0


def test_distance_stays_on_a_line_for_ever() -> None:
    start = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]])
    assert (run("distance", EQUILATERAL, start)[:, 1] == 0.0).all()


@given(seed=st.integers(0, 2**32 - 1), turn=st.floats(0.1, 3.0))
def test_a_family_needs_a_compass_exactly_if_it_says_so(seed: int, turn: float) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(5, rng)
    p = rng.normal(size=(5, 2))
    aligned = np.tile([1.0, 0.0], (5, 1))
    frame = np.exp(1j * turn)
    for family in ("displacement", "bearing", "distance"):
        law = LAWS[family](target)
        local = measured(family, target, p, frame)
        true_compass = as_vectors(np.full(5, frame))
        expected = as_vectors(as_complex(law(measured(family, target, p), aligned)) * frame)
        np.testing.assert_allclose(law(local, true_compass), expected, atol=1e-9)
        blind = law(local, aligned)
        assert law.needs_compass == bool(np.abs(blind - expected).max() > 1e-6)
    with pytest.raises(ValueError, match="compass is missing"):
        LAWS["bearing"](target)(measured("bearing", target, p))
