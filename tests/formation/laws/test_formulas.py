"""Every comparison law computes the formula of its docstring, agent by agent, wherever the agents are."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import LAWS, DirectedGraph, Framework, TargetFormation, random_target
from formation.audit import Subject
from formation.graph.designs import design
from formation.laws.affine import AffineLaw, UndirectedAffineLaw
from formation.laws.another_pair import SLOWEST, AnotherPairLaw
from formation.laws.displacement import drift
from formation.laws.feedforward import FeedForward, places, shares
from formation.laws.laplacian import LaplacianLaw, abscissa, design_gains, least_norm
from formation.laws.redundant import RedundantLaw
from formation.laws.triangles import TriangleSum
from formation.plane import as_complex, as_vectors

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=15)


def drawn(seed: int, n: int = 6) -> tuple[TargetFormation, np.ndarray, np.ndarray]:
    """A target, its places as complex numbers, and other places."""
    rng = np.random.default_rng(seed)
    target = random_target(n, rng, np.radians(20.0))
    return target, as_complex(target.positions), as_complex(rng.normal(size=(n, 2)))


def velocities(law: object, formation: Framework, p: np.ndarray, delta: complex | None = None) -> np.ndarray:
    """Complex velocities at complex places, in the common frame."""
    told = None if delta is None else (delta.real, delta.imag)
    return as_complex(Subject(law, formation, told)(as_vectors(p)))  # type: ignore[arg-type]


def neighbours(formation: Framework) -> list[list[int]]:
    k, i = formation.graph.edges.T
    return [i[k == row].tolist() for row in range(formation.graph.n)]


def circles(a: complex, b: complex, r_a: float, r_b: float) -> list[complex]:
    """Where two circles cross; where they do not, the foot of the line of equal power, twice."""
    base = b - a
    along = (r_a**2 - r_b**2 + abs(base) ** 2) / (2.0 * abs(base))
    across = np.sqrt(max(r_a**2 - along**2, 0.0))
    return [a + (along + side * 1j * across) * base / abs(base) for side in (1.0, -1.0)]


@EXAMPLES
@given(seed=SEEDS, scale=st.floats(0.5, 2.0), told=st.booleans())
def test_a_persistent_follower_heads_for_the_nearer_crossing_of_two_circles(
    seed: int, scale: float, told: bool
) -> None:
    target, star, p = drawn(seed)
    size = scale if told else 1.0
    u = velocities(LAWS["persistent"](target), target, p, scale * (star[1] - star[0]) * 1j if told else None)  # type: ignore[call-arg]
    assert u[0] == 0.0
    goal = p[0] + size * abs(star[1] - star[0]) * (p[1] - p[0]) / abs(p[1] - p[0])
    assert u[1] == pytest.approx(goal - p[1])
    for k, (i, j) in enumerate(target.graph.neighbours.tolist(), start=2):
        crossings = circles(p[i], p[j], size * abs(star[k] - star[i]), size * abs(star[k] - star[j]))
        assert u[k] == pytest.approx(min(crossings, key=lambda c: abs(c - p[k])) - p[k], abs=1e-9)


@EXAMPLES
@given(seed=SEEDS, scale=st.floats(0.5, 2.0), gain=st.floats(0.2, 3.0))
def test_an_area_follower_told_a_scale_wants_distances_times_it_and_areas_times_its_square(
    seed: int, scale: float, gain: float
) -> None:
    target, star, p = drawn(seed)
    law = LAWS["area"](target, gain=gain)  # type: ignore[call-arg]
    u = velocities(law, target, p, scale * (star[1] - star[0]) * np.exp(0.4j))
    for k, (i, j) in enumerate(target.graph.neighbours.tolist(), start=2):
        pulls = [(abs(p[k] - p[m]) ** 2 - (scale * abs(star[k] - star[m])) ** 2) * (p[k] - p[m]) for m in (i, j)]
        area, wanted = ((np.conj(q[j] - q[i]) * (q[k] - q[i])).imag for q in (p, star))
        expected = -sum(pulls) - gain * (area - scale**2 * wanted) * 1j * (p[j] - p[i])
        assert u[k] == pytest.approx(expected)


@EXAMPLES
@given(seed=SEEDS, speed=st.floats(0.1, 2.0))
def test_the_ratio_law_heads_for_the_place_of_eq_u_at_its_speed_over_the_sum_of_the_distances(
    seed: int, speed: float
) -> None:
    target, star, p = drawn(seed)
    u = velocities(LAWS["ratio"](target, speed=speed), target, p)  # type: ignore[call-arg]
    assert not u[:2].any()
    for k, (i, j) in enumerate(target.graph.neighbours.tolist(), start=2):
        w = (star[k] - star[i]) / (star[j] - star[i])
        goal = (1.0 - w) * p[i] + w * p[j]
        assert u[k] == pytest.approx(speed * (goal - p[k]) / (abs(p[i] - p[k]) + abs(p[j] - p[k])))


def test_rates_and_speeds_have_the_value_that_their_docstrings_promise_and_are_positive() -> None:
    target, _, p = drawn(3)
    for name, word, default in (("ratio", "speed", 0.5), ("redundant", "rate", 0.5), ("area", "gain", 1.0)):
        law, same = LAWS[name](target), LAWS[name](target, **{word: default})  # type: ignore[call-arg]
        np.testing.assert_array_equal(velocities(law, target, p), velocities(same, target, p))
    for name, word in (("ratio", "speed"), ("redundant", "rate")):
        for bad in (0.0, -1.0, np.nan):
            with pytest.raises(ValueError, match=f"{word} must be positive"):
                LAWS[name](target, **{word: bad})  # type: ignore[call-arg]


@EXAMPLES
@given(seed=SEEDS, lost=st.sets(st.integers(0, 14), max_size=6), rate=st.floats(0.1, 2.0))
def test_redundant_followers_use_whom_they_see_with_the_weights_of_least_norm(
    seed: int, lost: set[int], rate: float
) -> None:
    target, star, p = drawn(seed)
    formation = design("ordered", Framework(DirectedGraph(6, np.array([[1, 0]])), target.positions))
    edges = formation.graph.edges
    relative = as_vectors(p[edges[:, 1]] - p[edges[:, 0]])
    relative[list(lost)] = np.nan
    u = as_complex(RedundantLaw(formation, rate)(relative))
    assert not u[:2].any()
    for k in range(2, 6):
        seen = [int(edges[m, 1]) for m in range(len(edges)) if edges[m, 0] == k and m not in lost]
        expected = 0j
        if len(seen) >= 2:
            c = np.linalg.pinv(np.stack([np.ones(len(seen)), star[seen] - star[k]])) @ [1.0, 0.0]
            expected = rate * (c * (p[seen] - p[k])).sum()
        assert u[k] == pytest.approx(expected, abs=1e-9)


@EXAMPLES
@given(seed=SEEDS)
def test_affine_followers_keep_real_weights_of_three_that_give_their_place(seed: int) -> None:
    target, star, p = drawn(seed)
    formation = design("three before", target)
    u = velocities(AffineLaw(formation), formation, p)
    assert not u[:3].any()
    for k, seen in enumerate(neighbours(formation)):
        if k >= 3:
            z = star[seen] - star[k]
            c = np.linalg.lstsq(np.stack([np.ones(len(seen)), z.real, z.imag]), [1.0, 0.0, 0.0], rcond=None)[0]
            assert u[k] == pytest.approx((c * (p[seen] - p[k])).sum())


def test_leaders_of_an_affine_formation_stand_still_whomever_they_sense() -> None:
    target, star, p = drawn(3, 4)
    graph = DirectedGraph(4, np.array([[1, 0], [2, 0], [2, 1], [3, 0], [3, 1], [3, 2]]))
    formation = Framework(graph, target.positions)
    u = velocities(AffineLaw(formation), formation, p)
    assert not u[:3].any()
    assert u[3] != 0.0
    assert velocities(AffineLaw(formation), formation, star)[3] == pytest.approx(0.0, abs=1e-12)


def test_affine_followers_of_neighbours_on_one_line_are_refused_by_number() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    graph = DirectedGraph(4, np.array([[3, 0], [3, 1], [3, 2]]))
    with pytest.raises(ValueError, match="the neighbours of agent 4 are collinear"):
        AffineLaw(Framework(graph, places))


def test_the_undirected_affine_law_keeps_three_leaders_and_leaves_exactly_affine_images_at_rest() -> None:
    target, star, _ = drawn(4)
    formation = design("universally rigid", target)
    law = UndirectedAffineLaw(formation)
    image = 2.0 * star.real + 0.3 * star.imag + 1j * (0.4 * star.imag - star.real) + 1.0 - 2.0j
    np.testing.assert_allclose(velocities(law, formation, image), 0.0, atol=1e-9)
    moved = image.copy()
    moved[4] += 0.1
    u = velocities(law, formation, moved)
    assert not u[:3].any()
    assert (u[4] / 0.1).real < -0.5


@pytest.mark.parametrize("wrapped", [0.0, 1.0])
@EXAMPLES
@given(seed=SEEDS)
def test_bisector_agents_move_along_the_bisectors_of_their_angles(wrapped: float, seed: int) -> None:
    target, star, p = drawn(seed, 5)
    formation = design("signed angles", target)
    law = LAWS["bisector"](formation, wrapped=wrapped)  # type: ignore[call-arg]
    u = velocities(law, formation, p)
    for k, seen in enumerate(neighbours(formation)):
        expected = 0j
        for a, b in pairwise(seen):
            turn, wanted = (np.angle((q[b] - q[k]) / (q[a] - q[k])) % (2.0 * np.pi) for q in (p, star))
            if wanted > np.pi:  # the same angle, taken the other way round
                turn, wanted = -turn % (2.0 * np.pi), -wanted % (2.0 * np.pi)
            error = turn - wanted
            if wrapped:
                error = np.angle(np.exp(1j * error))
            ways = [(p[m] - p[k]) / abs(p[m] - p[k]) for m in (a, b)]
            expected -= error * sum(ways)
        assert u[k] == pytest.approx(expected, abs=1e-9)
    np.testing.assert_allclose(velocities(law, formation, star), 0.0, atol=1e-12)


def test_bisector_angles_are_not_wrapped_unless_asked() -> None:
    target, _, _ = drawn(4, 5)
    formation = design("signed angles", target)
    p = as_complex(np.random.default_rng(9).normal(size=(5, 2)))
    plain, same, other = (
        velocities(law, formation, p)
        for law in (
            LAWS["bisector"](formation),  # type: ignore[call-arg]
            LAWS["bisector"](formation, wrapped=0.0),  # type: ignore[call-arg]
            LAWS["bisector"](formation, wrapped=1.0),  # type: ignore[call-arg]
        )
    )
    np.testing.assert_array_equal(plain, same)
    assert np.abs(plain - other).max() > 0.1


@EXAMPLES
@given(seed=SEEDS)
def test_three_agents_by_angles_move_along_their_bisectors_and_rest_in_the_mirror_image(seed: int) -> None:
    target, star, p = drawn(seed, 3)
    formation = design("triangle", target)
    law = LAWS["triangle-angles"](formation)  # type: ignore[call-arg]
    u = velocities(law, formation, p)
    for v in range(3):
        a, b = (m for m in range(3) if m != v)
        found, wanted = (abs(np.angle((q[b] - q[v]) / (q[a] - q[v]))) for q in (p, star))
        ways = [(p[m] - p[v]) / abs(p[m] - p[v]) for m in (a, b)]
        assert u[v] == pytest.approx(-(found - wanted) * sum(ways))
    np.testing.assert_allclose(velocities(law, formation, np.conj(star)), 0.0, atol=1e-12)


@EXAMPLES
@given(seed=SEEDS)
def test_the_laplacian_has_weights_of_least_norm_that_give_every_place(seed: int) -> None:
    _, star, p = drawn(seed)
    formation = Framework(DirectedGraph(6, np.array([(k, i) for k in range(2, 6) for i in range(k)])), as_vectors(star))
    law = LaplacianLaw(formation, 0.0)
    assert (law.gains == 1.0).all()
    u, matrix = velocities(law, formation, p), law.matrix()
    assert not u[:2].any()
    for k in range(2, 6):
        seen = list(range(k))
        c = np.linalg.pinv(np.stack([np.ones(k), star[seen] - star[k]])) @ [1.0, 0.0]
        assert u[k] == pytest.approx((c * (p[seen] - p[k])).sum())
    np.testing.assert_allclose(matrix @ p, u, atol=1e-12)
    np.testing.assert_allclose(np.diagonal(matrix)[2:], -1.0)
    with pytest.raises(ValueError, match="agent 3 senses fewer than two agents"):
        least_norm(np.ones(1, dtype=complex), np.array([2]), 3)


def test_gains_are_designed_only_where_the_slowest_mode_needs_it_and_then_all_modes_decay() -> None:
    fast, slow = np.diag([-1.0 + 0j, -0.26]), np.diag([-1.0 + 0j, -0.24])
    assert (design_gains(fast) == 1.0).all()
    gains = design_gains(slow)
    np.testing.assert_allclose(np.abs(gains), 1.0)
    assert abscissa(slow, gains) == pytest.approx(-0.24, abs=1e-3)
    turned = np.array([[-1.0 + 0j, 0.3], [0.2, -1.0]]) * np.exp(1j * np.array([2.0, -2.5]))[:, None]
    assert abscissa(turned, np.ones(2)) > 0.0
    best = max(
        -abscissa(turned, np.exp(1j * np.array([a, b])))
        for a in np.linspace(-np.pi, np.pi, 60)
        for b in np.linspace(-np.pi, np.pi, 60)
    )
    found = design_gains(turned)
    np.testing.assert_allclose(np.abs(found), 1.0)
    assert -abscissa(turned, found) >= best - 1e-3
    with pytest.raises(ValueError, match="no stabilising gains were found"):
        design_gains(np.zeros((2, 2), dtype=complex))


@EXAMPLES
@given(seed=SEEDS, mu=st.complex_numbers(max_magnitude=2.0))
def test_the_feed_forward_is_that_of_its_docstring_out_of_shape_too(seed: int, mu: complex) -> None:
    target, star, p = drawn(seed)
    z = (star - star[0]) / (star[1] - star[0])
    np.testing.assert_allclose(places(target), z, atol=1e-12)
    edges = target.graph.edges
    u = as_complex(FeedForward(target)(as_vectors(p[edges[:, 1]] - p[edges[:, 0]]), mu))
    assert u[0] == 0.0
    assert u[1] == pytest.approx(mu * (p[1] - p[0]))
    for k, (i, j) in enumerate(target.graph.neighbours.tolist(), start=2):
        assert shares(target)[k - 2] == pytest.approx(z[k] / (z[j] - z[i]))
        assert u[k] == pytest.approx(mu * z[k] / (z[j] - z[i]) * (p[j] - p[i]))


@EXAMPLES
@given(seed=SEEDS)
def test_with_compass_errors_the_centre_of_the_undirected_displacement_law_drifts_from_the_first_instant(
    seed: int,
) -> None:
    target, _, p = drawn(seed)
    formation = design("undirected", target)
    errors = np.random.default_rng(seed).normal(0.0, 0.3, (2, 6))
    for each, found in zip(errors, drift(formation, errors), strict=True):
        edges = formation.graph.edges
        compass = as_vectors(np.exp(1j * each))
        u = LAWS["displacement-undirected"](formation)(as_vectors(p[edges[:, 1]] - p[edges[:, 0]]), compass)
        np.testing.assert_allclose(u.mean(axis=0), found, atol=1e-12)


def test_each_triangle_is_seen_from_each_of_its_corners_turned_the_same_way() -> None:
    formation = Framework(DirectedGraph.both_ways(4, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]), np.eye(4, 2) + 0.1)
    law = LAWS["triangular"](formation)  # type: ignore[call-arg]
    assert isinstance(law, TriangleSum)
    expected = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 2, 3], [2, 3, 1], [3, 1, 2]]
    assert law.corners.tolist() == expected


@pytest.mark.parametrize("name", LAWS)
def test_the_leaders_that_a_law_declares_stand_still_and_nobody_else_does(name: str) -> None:
    target, _, p = drawn(6, 3 if LAWS[name].graph == "triangle" else 6)
    formation = design(LAWS[name].graph, target)
    still = np.abs(velocities(LAWS[name](formation), formation, p)) == 0.0  # type: ignore[call-arg]
    assert still[: LAWS[name].leaders].all()
    assert still.sum() == LAWS[name].leaders


def test_followers_fall_back_on_the_fastest_pair_that_they_see() -> None:
    target, star, p = drawn(7)
    gains = np.array([0.5, 1.5, 2.0, 0.7])
    law = AnotherPairLaw(target, own_gains=gains)
    plain = AnotherPairLaw(target)
    observer, observed = law.edges.T
    rng = np.random.default_rng(1)
    used = 0
    for _ in range(40):
        lost = rng.random(len(law.edges)) < 0.5
        relative = p[observed] - p[observer]
        relative[lost] = np.nan
        u, v = (as_complex(each(as_vectors(relative))) for each in (law, plain))
        for k in range(2, 6):
            seen = {int(i) for i, gone in zip(observed[observer == k], lost[observer == k], strict=True) if not gone}
            own = target.graph.neighbours[k - 2].tolist()
            pairs = [own] if set(own) <= seen else list(combinations(sorted(seen), 2))
            rates = [np.sin(np.angle((star[j] - star[k]) / (star[i] - star[k]))) ** 2 for i, j in pairs]
            if not pairs or max(rates) < SLOWEST:
                assert np.isnan(u[k])
                continue
            (i, j), rate = pairs[int(np.argmax(rates))], max(rates)
            w = (star[k] - star[i]) / (star[j] - star[i])
            expected = rate * ((1.0 - w) * p[i] + w * p[j] - p[k])
            assert v[k] == pytest.approx(expected)
            assert u[k] == pytest.approx(gains[k - 2] * expected)
            used += pairs[0] != own
    assert used > 20
