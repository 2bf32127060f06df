"""Derivatives by the places of agents, beside differences of what they are the derivatives of."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formation import SensingGraph, TargetFormation
from formation.graph.constructions import angle_slopes
from formation.graph.rigidity import rigidity_matrix, undirected_pairs

STEP = 1e-6
seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds)
def test_the_slopes_of_the_angles_at_a_vertex_are_their_derivatives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    seen = np.exp(2j * np.pi * (np.arange(3) / 3.0 + rng.uniform(-0.1, 0.1, 3))) * rng.uniform(1.0, 2.0, 3)

    def angles(vertex: complex) -> np.ndarray:
        rays = seen - vertex
        return np.angle(rays[1:] / rays[:-1])

    found = angle_slopes(seen)
    for column, step in enumerate((STEP, 1j * STEP)):
        np.testing.assert_allclose(found[:, column], (angles(step) - angles(-step)) / (2.0 * STEP), atol=1e-7)


@given(seed=seeds, bearings=st.booleans())
def test_the_rows_of_the_rigidity_matrix_are_the_derivatives_of_distances_and_of_bearings(
    seed: int, bearings: bool
) -> None:
    rng = np.random.default_rng(seed)
    angles = 2.0 * np.pi * (np.arange(5) + rng.uniform(-0.2, 0.2, 5)) / 5.0
    places = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    target = TargetFormation(SensingGraph(np.array([[0, 1], [1, 2], [0, 3]])), places)
    pairs = undirected_pairs(target.graph.edges)

    def constrained(p: np.ndarray) -> np.ndarray:
        along = p[pairs[:, 1]] - p[pairs[:, 0]]
        return np.arctan2(along[:, 1], along[:, 0]) if bearings else np.linalg.norm(along, axis=1)

    size = np.linalg.norm(places[pairs[:, 1]] - places[pairs[:, 0]], axis=1) if bearings else np.ones(len(pairs))
    motion = rng.normal(size=places.shape)
    change = (constrained(places + STEP * motion) - constrained(places - STEP * motion)) / (2.0 * STEP)
    np.testing.assert_allclose(rigidity_matrix(target, bearings) @ motion.ravel(), change * size, atol=1e-7)
