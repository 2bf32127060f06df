"""Random targets keep what they promise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import random_target
from formation.random_target import _disc, _Taken


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 30), degrees=st.floats(1.0, 25.0))
def test_every_interior_angle_stays_away_from_flat(seed: int, n: int, degrees: float) -> None:
    target = random_target(n, np.random.default_rng(seed), min_angle=np.radians(degrees))
    assert (np.abs(np.sin(target.interior_angles)) >= np.sin(np.radians(degrees)) - 1e-12).all()


@given(seed=st.integers(0, 2**32 - 1))
def test_agents_stay_apart_and_inside_the_disc(seed: int) -> None:
    p = random_target(12, np.random.default_rng(seed), min_separation=0.3, radius=2.0).positions
    gaps = np.linalg.norm(p[:, None] - p, axis=-1)[np.triu_indices(12, 1)]
    assert gaps.min() >= 0.3
    assert np.linalg.norm(p, axis=1).max() <= 2.0


def test_a_disc_that_is_too_small_is_refused_with_the_agent() -> None:
    with pytest.raises(ValueError, match=r"no place for agent \d+ of 30: radius 1 m is too small"):
        random_target(30, np.random.default_rng(0), min_separation=1.0)
    with pytest.raises(ValueError, match="at least 3 agents"):
        random_target(2, np.random.default_rng(0))


def test_places_are_drawn_with_the_same_density_all_over_the_disc() -> None:
    """Of a uniform disc a quarter lies within half the radius; its radii squared are uniform."""
    places = _disc(20_000, 2.0, np.random.default_rng(0))
    squared = (places**2).sum(axis=1) / 4.0
    assert squared.max() <= 1.0
    np.testing.assert_allclose(np.quantile(squared, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.015)
    np.testing.assert_allclose(places.mean(axis=0), 0.0, atol=0.03)


@given(
    points=st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=30),
    separation=st.sampled_from([0.0, 0.01, 0.1, 0.5, 3.0]),
)
def test_a_place_is_free_where_no_agent_at_all_is_too_near(
    points: list[tuple[float, float]], separation: float
) -> None:
    taken = _Taken(separation)
    there: list[np.ndarray] = []
    for point in map(np.array, points):
        free = all(np.linalg.norm(point - other) >= separation for other in there)
        assert taken.free(point) == free
        if free:
            taken.add(point)
            there.append(point)
