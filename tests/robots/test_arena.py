"""The arena."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import ROBOTARIUM_FLOOR, Arena


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_a_point_is_on_the_floor_when_both_coordinates_are_within_the_sides(x: float, y: float) -> None:
    assert ROBOTARIUM_FLOOR.contains(np.array([x, y])) == (abs(x) <= 1.6 and abs(y) <= 1.0)


def test_the_corners_belong_to_the_floor_and_go_round_counter_clockwise() -> None:
    corners = ROBOTARIUM_FLOOR.corners
    assert ROBOTARIUM_FLOOR.contains(corners).all()
    x, y = corners.T
    area = 0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    assert area == pytest.approx(3.2 * 2.0)


def test_a_place_that_is_not_a_number_is_not_on_the_floor() -> None:
    assert not ROBOTARIUM_FLOOR.contains(np.array([np.nan, 0.0]))


@pytest.mark.parametrize("side", [(1.0, 1.0), (1.0, -1.0), (np.nan, 1.0), (0.0, np.inf)])
def test_an_arena_without_floor_is_refused(side: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="x must be"):
        Arena(x=side, y=(0.0, 1.0))
    with pytest.raises(ValueError, match="y must be"):
        Arena(x=(0.0, 1.0), y=side)
