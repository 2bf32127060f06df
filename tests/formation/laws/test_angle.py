"""The law: gains, equilibria, frames, locality, closed-loop eigenvalues."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import AngleLaw, SensingGraph, Similarity, TargetFormation, decay_rates, follower_gains
from formation.plane import as_complex, as_vectors

seeds = st.integers(0, 2**32 - 1)
LAWS = ["stationary", "displacement", "distance", "bearing", "spiral"]


def random_target(seed: int, n: int = 7) -> TargetFormation:
    """A target whose triangles are not too flat."""
    rng = np.random.default_rng(seed)
    while True:
        target = TargetFormation(SensingGraph.random(n, rng), rng.uniform(-1.0, 1.0, (n, 2)))
        if decay_rates(target).min() > 0.01:
            return target


def relative(target: TargetFormation, points: np.ndarray) -> np.ndarray:
    observer, observed = target.graph.edges.T
    return points[..., observed, :] - points[..., observer, :]


def in_frames(vectors: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Vectors (m, 2) seen from frames (m,), complex unit x axes."""
    return as_vectors(as_complex(vectors) * np.conj(frames))


@given(seeds)
def test_the_two_gains_of_a_follower_add_up_to_the_squared_sine_of_its_angle(seed: int) -> None:
    target = random_target(seed)
    np.testing.assert_allclose(follower_gains(target).sum(axis=1), np.sin(target.follower_angles) ** 2, atol=1e-14)


@given(seeds)
def test_the_closed_loop_has_the_eigenvalues_minus_sin_squared(seed: int) -> None:
    target = random_target(seed)
    law, n = AngleLaw(target), target.graph.n
    columns = [as_complex(law(relative(target, as_vectors(unit)))) for unit in np.eye(n, dtype=complex)]
    found = np.sort_complex(np.linalg.eigvals(np.stack(columns, axis=1)))
    expected = np.sort_complex(np.concatenate([-decay_rates(target), [0.0, 0.0]]).astype(complex))
    np.testing.assert_allclose(found, expected, atol=1e-9)


@given(seeds, st.floats(0.1, 5.0), st.floats(0.0, 6.28))
def test_every_similarity_of_the_target_is_an_equilibrium(seed: int, scale: float, theta: float) -> None:
    target = random_target(seed)
    points = Similarity(scale, theta, (3.0, -2.0))(target.positions)
    assert np.abs(AngleLaw(target)(relative(target, points))).max() < 1e-12


@given(seeds)
def test_the_law_is_equation_u_in_the_papers_matrices(seed: int) -> None:
    target = random_target(seed)
    points = np.random.default_rng(seed).normal(size=(target.graph.n, 2))
    u = AngleLaw(target)(relative(target, points))
    for (i, j, k), coefficients in zip(target.graph.triangles, target.coefficients, strict=True):
        a_i, a_j, a_k = (np.array([[c.real, -c.imag], [c.imag, c.real]]) for c in coefficients)
        expected = -a_k.T @ (a_i @ (points[i] - points[k]) + a_j @ (points[j] - points[k]))
        np.testing.assert_allclose(u[k], expected, atol=1e-13)
    assert (u[:2] == 0.0).all()


@given(seeds)
def test_turning_the_frame_of_every_agent_turns_its_velocity_and_nothing_else(seed: int) -> None:
    target = random_target(seed)
    rng = np.random.default_rng(seed)
    edges = relative(target, rng.normal(size=(target.graph.n, 2)))
    frames = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, target.graph.n))
    law = AngleLaw(target)
    local = law(in_frames(edges, frames[target.graph.edges[:, 0]]))
    np.testing.assert_allclose(as_vectors(as_complex(local) * frames), law(edges), atol=1e-13)


@given(seeds)
def test_a_mirrored_frame_changes_the_velocity(seed: int) -> None:
    target = random_target(seed)
    edges = relative(target, np.random.default_rng(seed).normal(size=(target.graph.n, 2)))
    law, mirror = AngleLaw(target), np.array([1.0, -1.0])
    assert np.abs(law(edges * mirror) * mirror - law(edges))[2:].max() > 1e-3


@pytest.mark.parametrize("first_follower", LAWS)
def test_an_agent_is_blind_to_every_row_but_its_own(first_follower: str) -> None:
    target = random_target(3)
    law, graph = AngleLaw(target, first_follower), target.graph
    rng = np.random.default_rng(0)
    edges = rng.normal(size=(len(graph.edges), 2))
    compass = as_vectors(np.exp(1j * rng.uniform(0.0, 6.0, graph.n)))
    delta = np.array([0.3, 0.4])
    whole = law(edges, compass, delta)
    for k in range(graph.n):
        mine = graph.edges[:, 0] == k
        poisoned_edges = np.where(mine[:, None], edges, np.nan)
        poisoned_compass = np.where((np.arange(graph.n) == k)[:, None], compass, np.nan)
        with np.errstate(invalid="ignore"):  # the bearing of poison
            assert (law(poisoned_edges, poisoned_compass, delta)[k] == whole[k]).all()


@pytest.mark.parametrize("first_follower", ["stationary", "distance"])
def test_a_law_without_compass_never_reads_one(first_follower: str) -> None:
    target = random_target(3)
    law = AngleLaw(target, first_follower)
    assert not law.needs_compass
    edges = relative(target, np.random.default_rng(0).normal(size=(target.graph.n, 2)))
    blind, seeing = law(edges, None, np.ones(2)), law(edges, np.full((target.graph.n, 2), np.nan), np.ones(2))
    assert (blind == seeing).all()


@pytest.mark.parametrize("first_follower", LAWS)
def test_a_batch_equals_its_single_runs(first_follower: str) -> None:
    target = random_target(4)
    law = AngleLaw(target, first_follower)
    rng = np.random.default_rng(0)
    edges = rng.normal(size=(2, 3, len(target.graph.edges), 2))
    compass = as_vectors(np.exp(1j * rng.uniform(0.0, 6.0, (2, 3, target.graph.n))))
    batch = law(edges, compass, np.array([0.3, 0.4]))
    single = law(edges[1, 2], compass[1, 2], np.array([0.3, 0.4]))
    np.testing.assert_allclose(batch[1, 2], single, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda t: AngleLaw(t, "berring"), "first_follower must be one of"),
        (lambda t: AngleLaw(t, "distance")(np.zeros((11, 2))), "delta is missing"),
        (lambda t: AngleLaw(t, "bearing")(np.zeros((11, 2)), None, np.ones(2)), "compass is missing"),
    ],
)
def test_what_a_law_needs_and_does_not_get_is_named(make: Callable[[TargetFormation], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make(random_target(0))
