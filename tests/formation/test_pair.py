"""Where the leader and the first follower end, phase by phase, and what agents measure."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import formation
from formation import Phase, SensingGraph, pair_ends
from formation.angles import AngleSet, signed_angle
from formation.graph.edges import corners, rows_of, triangles
from formation.maneuver import pair_places
from formation.measurements import KINDS, perfect
from formation.plane import as_complex, as_vectors
from formation.references.curves import ClosedCurve
from formation.references.protocol import check_times, pair_displacement

SEEDS = st.integers(0, 2**32 - 1)
CURVE = ClosedCurve("ellipse", (2.0, 1.0), 20.0, 0.3)


@pytest.mark.parametrize("law", ["stationary", "displacement", "distance", "bearing", "spiral"])
@pytest.mark.parametrize("feedforward", [False, True])
def test_a_pair_goes_from_phase_to_phase_with_what_its_law_does_not_steer_kept(law: str, feedforward: bool) -> None:
    start = np.array([[1.0, 2.0], [1.5, 2.5], [9.0, 9.0]])
    phases = [
        Phase("a", 2.0, (0.5, -1.0), (0.0, 0.4)),
        Phase("b", 3.0, (0.1, 0.0)),
        Phase("c", 5.0, (7.0, 7.0), (0.3, 0.3), CURVE),
        Phase("d", 1.0, (0.0, 1.0), (-0.2, 0.0)),
    ]
    leader, e = 1.0 + 2.0j, 0.5 + 0.5j

    def steered(e: complex, delta: complex) -> complex:
        return {
            "stationary": e, "displacement": delta, "spiral": delta,
            "distance": abs(delta) * e / abs(e), "bearing": abs(e) * delta / abs(delta),
        }[law]  # fmt: skip

    expected = []
    for velocity, duration, delta in (((0.5, -1.0), 2.0, 0.4j), ((0.1, 0.0), 3.0, None)):
        leader += complex(*velocity) * duration
        e = e if delta is None else steered(e, delta)
        expected.append([leader, leader + e])
    leader += complex(CURVE.path(5.0))
    e = complex(pair_displacement(CURVE, e, 0.3 + 0.3j, law, feedforward, 5.0))
    expected.append([leader, leader + e])
    e = steered(e, -0.2 + 0j)
    expected.append([leader + 1j, leader + 1j + e])
    np.testing.assert_allclose(as_complex(pair_ends(start, phases, law, feedforward)), expected, atol=1e-12)


def test_places_of_a_pair_on_its_way_are_those_of_its_reference() -> None:
    phase = Phase("c", 5.0, delta=(0.3, 0.3), reference=CURVE)
    t = np.linspace(0.0, 5.0, 4)
    leader, first = pair_places((np.asarray(1.0j), np.asarray(2.0 + 0j)), phase, "displacement", False, t)
    np.testing.assert_allclose(leader, 1.0j + CURVE.path(t))
    np.testing.assert_allclose(first - leader, (0.3 + 0.3j) * CURVE.factor(t))
    with pytest.raises(ValueError, match="phase d has no reference"):
        pair_places((np.asarray(0j), np.asarray(1 + 0j)), Phase("d", 1.0), "displacement", False, t)


def test_a_phase_moves_if_it_has_a_velocity_in_any_direction_or_a_reference() -> None:
    assert [Phase("", 1.0, v).moving for v in ((0.0, 0.0), (0.1, 0.0), (0.0, 0.1))] == [False, True, True]
    assert Phase("", 1.0, reference=CURVE).moving
    assert Phase("", 1.0).bends == Phase("", 1.0, reference=CURVE).bends == []
    assert Phase("", 1.0).displacement is None
    assert Phase("", 1.0, delta=(1.0, 2.0)).displacement == 1.0 + 2.0j


@pytest.mark.parametrize(
    ("times", "word"),
    [
        ([0.0], "at least two of them, got 1"), ([0.5, 1.0], "the first is 0.5"),
        ([0.0, 1.0, 1.0], "number 3 is 1 after 1"), ([0.0, 2.0, 1.5, 1.0], "number 3 is 1.5 after 2"),
        ([0.0, np.nan], "number 2 is nan after 0"),
    ],
)  # fmt: skip
def test_times_that_do_not_go_on_are_told_by_number(times: list[float], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        check_times(np.array(times))
    check_times(np.array([0.0, 0.25, 0.5]))


@given(seed=SEEDS)
def test_a_closed_curve_is_the_one_of_its_formula_in_its_direction(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (width, height), period, aim = rng.uniform(0.5, 2.0, 2), rng.uniform(5.0, 50.0), rng.uniform(-3.0, 3.0)
    t = rng.uniform(0.0, period, 6)
    phi = 2.0 * np.pi * t / period
    wanted = {
        "ellipse": (width * np.sin(phi) + 1j * height * (1.0 - np.cos(phi))) / 2.0,
        "figure-eight": (width * np.sin(phi) + 1j * height * np.sin(2.0 * phi)) / 2.0,
    }
    for shape, path in wanted.items():
        for clockwise in (False, True):
            curve = ClosedCurve(shape, (width, height), period, aim, clockwise, turning=False)
            way = np.conj(path) if clockwise else path
            np.testing.assert_allclose(curve.path(t), np.exp(1j * aim) * way, atol=1e-12)
            assert (curve.factor(t) == 1.0).all()
            assert not np.any(curve.rate(t))
            assert curve.cycle == period


@pytest.mark.parametrize(("size", "period"), [((0.0, 1.0), 5.0), ((1.0, -1.0), 5.0), ((1.0, 1.0), 0.0)])
def test_a_curve_without_width_or_period_is_refused(size: tuple[float, float], period: float) -> None:
    with pytest.raises(ValueError, match="size and period must be positive"):
        ClosedCurve("circle", size, period)
    with pytest.raises(ValueError, match="shape must be one of circle, ellipse, figure-eight, got 'square'"):
        ClosedCurve("square", (1.0, 1.0), 1.0)


@given(seed=SEEDS)
def test_perfect_measurements_are_what_their_kinds_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edges = SensingGraph.random(5, rng).edges
    pairs = corners(edges)
    p = as_complex(rng.normal(size=(2, 5, 2)))
    e = p[:, edges[:, 1]] - p[:, edges[:, 0]]
    position, bearing, distance, angle, ratio = perfect(KINDS, as_vectors(e), pairs)
    np.testing.assert_array_equal(as_complex(position), e)
    np.testing.assert_allclose(as_complex(bearing) * distance, e)
    np.testing.assert_allclose(np.abs(as_complex(bearing)), 1.0)
    for column, (first, second) in enumerate(pairs.tolist()):
        k, a, b = edges[first, 0], edges[first, 1], edges[second, 1]
        assert edges[second, 0] == k
        np.testing.assert_allclose(angle[:, column], signed_angle(*(as_vectors(p[:, m]) for m in (k, a, b))), atol=1e-9)
        np.testing.assert_allclose(ratio[:, column], np.abs(p[:, b] - p[:, k]) / np.abs(p[:, a] - p[:, k]))
    assert (angle >= 0.0).all()
    with pytest.raises(ValueError, match="measures must be among relative position, bearing"):
        perfect(["colour"], as_vectors(e), pairs)


@given(seed=SEEDS, n=st.integers(3, 7))
def test_each_agent_has_two_angles_of_the_triangle_in_which_it_is_roundest(seed: int, n: int) -> None:
    places = np.random.default_rng(seed).normal(size=(n, 2))
    found = AngleSet.of_places(places).triples.reshape(n - 2, 2, 3)

    def roundness(i: int, j: int, k: int) -> float:
        a, b, c = as_complex(places)[[i, j, k]]
        longest = max(abs(a - b), abs(b - c), abs(c - a))
        return float(abs((np.conj(b - a) * (c - a)).imag) / longest**2)  # height over base

    for k, ((v_1, a_1, b_1), (v_2, a_2, b_2)) in enumerate(found.tolist(), start=2):
        best = max(combinations(range(k), 2), key=lambda pair, k=k: roundness(*pair, k))  # type: ignore[misc]
        assert (a_2, b_2) == best
        assert (v_1, a_1, b_1, v_2) == (b_2, a_2, k, k)


def test_rows_are_found_by_edge_and_triangles_are_mutual() -> None:
    edges = np.array([[0, 1], [1, 0], [1, 2], [2, 1], [0, 2], [2, 0], [2, 3], [3, 2], [1, 3]])
    assert triangles(edges).tolist() == [[0, 1, 2]]
    assert rows_of(edges, np.array([[[2, 0], [0, 1]], [[1, 3], [1, 3]]])).tolist() == [[5, 0], [8, 8]]
    with pytest.raises(ValueError, match=r"edge \(4, 2\) is missing"):
        rows_of(edges, np.array([[0, 1], [3, 1]]))
    assert corners(np.empty((0, 2), dtype=int)).shape == (0, 2)


def test_the_package_knows_its_version_and_no_other_name_that_is_not_there() -> None:
    assert formation.__version__.count(".") == 2
    with pytest.raises(AttributeError, match="has no attribute 'version'"):
        _ = formation.version
