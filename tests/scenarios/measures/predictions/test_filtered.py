"""Headings that follow a way in closed form, beside the differential equation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.measures.predictions.filtered import ROUNDS, _headings


@settings(max_examples=20)
@given(seed=st.integers(0, 2**32 - 1), ahead=st.floats(0.01, 0.2))
def test_headings_turn_towards_their_ways_as_the_near_identity_map_turns_them(seed: int, ahead: float) -> None:
    rng, step, parts = np.random.default_rng(seed), 0.05, 400
    way = np.cumsum(rng.normal(0.0, 0.03, (8, 3)) + 1j * rng.normal(0.0, 0.03, (8, 3)), axis=0)
    phi, expected = np.angle(way[0]), np.empty(way.shape)
    for _ in range(ROUNDS):
        for row, wanted in enumerate(way):
            expected[row] = phi
            for _ in range(parts):  # midpoint rule
                half = phi + 0.5 * step / parts * (wanted * np.exp(-1j * phi)).imag / ahead
                phi = phi + step / parts * (wanted * np.exp(-1j * half)).imag / ahead
    found = _headings(way, step, ahead)
    np.testing.assert_allclose(found, np.exp(1j * expected), atol=1e-4)
    np.testing.assert_allclose(np.abs(found), 1.0, atol=1e-12)


@pytest.mark.parametrize(("ahead", "step"), [(1e-9, 0.1), (0.05, 1e6)])
def test_who_turns_at_once_heads_where_its_point_went(ahead: float, step: float) -> None:
    way = 0.2 * np.exp(1j * np.linspace(0.1, 3.0, 30))[:, None]
    np.testing.assert_allclose(_headings(way, step, ahead)[1:], (way / 0.2)[:-1], atol=1e-12)
