"""Laplacians and neighbours."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.rps.version1 import graph as first
from robots.rps.version2 import graph as second


def connected(laplacian: np.ndarray) -> bool:
    return bool(np.linalg.eigvalsh(laplacian)[min(1, len(laplacian) - 1)] > 1e-9) or len(laplacian) == 1


def check(laplacian: np.ndarray, edges: int) -> None:
    np.testing.assert_array_equal(laplacian, laplacian.T)
    np.testing.assert_array_equal(laplacian.sum(axis=1), 0.0)
    assert set(laplacian[~np.eye(len(laplacian), dtype=bool)].tolist()) <= {0.0, -1.0}
    assert np.trace(laplacian) == 2 * edges


@given(st.integers(3, 30))
def test_fixed_graphs_have_the_edges_of_their_name(n: int) -> None:
    check(second.completeGL(n), n * (n - 1) // 2)
    check(second.cycleGL(n), n)
    check(second.lineGL(n), n - 1)
    np.testing.assert_array_equal(first.cycle_GL(n), second.cycleGL(n))
    assert sorted(np.diag(second.lineGL(n)).tolist())[:3] == [1.0, 1.0, 2.0]
    assert (np.diag(second.cycleGL(n)) == 2.0).all()


@pytest.mark.parametrize("module", [first, second])
def test_random_graphs_have_the_edges_that_are_asked_for(module: object, global_draws: Callable[[int], None]) -> None:
    for v, e in ((1, 0), (2, 5), (6, 0), (6, 4), (6, 100), (12, 9)):
        most = v * (v - 1) // 2
        tree = module.random_connectedGL(v, e)  # type: ignore[attr-defined]
        check(tree, min(most, v - 1 + e))
        assert connected(tree)
        check(module.randomGL(v, e), min(most, e))  # type: ignore[attr-defined]


def test_random_graphs_are_the_seeds(global_draws: Callable[[int], None]) -> None:
    for module in (first, second):
        drawn = []
        for seed in (1, 1, 2):
            global_draws(seed)
            drawn.append(module.random_connectedGL(9, 5))
        np.testing.assert_array_equal(drawn[0], drawn[1])
        assert (drawn[0] != drawn[2]).any()


@given(st.integers(0, 4), st.floats(0.0, 3.0))
def test_the_disk_holds_who_is_within_it(agent: int, delta: float) -> None:
    poses = np.random.default_rng(5).uniform(-1.0, 1.0, (3, 5))
    near = [other for other in range(5) if other != agent and np.hypot(*(poses[:2, other] - poses[:2, agent])) <= delta]
    assert second.delta_disk_neighbors(poses, agent, delta).tolist() == near


def test_neighbours_are_read_from_the_laplacian_which_stays_as_it_was() -> None:
    laplacian = second.lineGL(4)
    assert second.topological_neighbors(laplacian, 1).tolist() == [0, 2]
    np.testing.assert_array_equal(laplacian, second.lineGL(4))
    with pytest.raises(ValueError, match=r"0\.\.3"):
        second.topological_neighbors(laplacian, 4)
    with pytest.raises(ValueError, match="n must be a whole number from 3 on"):
        second.cycleGL(2)
