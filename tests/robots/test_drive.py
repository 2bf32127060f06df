"""The differential drive: round trips and limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, DifferentialDrive

DRIVE = GTERNAL.drive
pairs = st.tuples(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0)).map(np.array)


@given(pairs)
def test_twist_and_wheel_speeds_are_inverse_to_each_other(wheels: np.ndarray) -> None:
    np.testing.assert_allclose(DRIVE.wheel_speeds(DRIVE.twist(wheels)), wheels, atol=1e-11)


def test_equal_wheels_drive_straight_and_a_faster_right_wheel_turns_left() -> None:
    assert DRIVE.twist(np.array([5.0, 5.0])) == pytest.approx([0.08, 0.0])
    v, omega = DRIVE.twist(np.array([-5.0, 5.0]))
    assert v == pytest.approx(0.0)
    assert omega == pytest.approx(2.0 * 0.016 * 5.0 / 0.11)


def test_the_robotariums_limits_are_those_of_its_wheels() -> None:
    assert DRIVE.speed_limit == pytest.approx(0.2)
    assert DRIVE.turn_limit == pytest.approx(3.636, abs=5e-4)
    assert DRIVE.twist(np.array([12.5, 12.5]))[0] == pytest.approx(DRIVE.speed_limit)
    assert DRIVE.twist(np.array([-12.5, 12.5]))[1] == pytest.approx(DRIVE.turn_limit)


@pytest.mark.parametrize("how", ["scale", "clip"])
@given(wheels=pairs)
def test_saturation_respects_the_limit_and_leaves_what_is_within_it(how: str, wheels: np.ndarray) -> None:
    limited = DRIVE.saturate(wheels, how)  # type: ignore[arg-type]
    assert np.abs(limited).max() <= DRIVE.wheel_speed_limit * (1.0 + 1e-15)
    if np.abs(wheels).max() <= DRIVE.wheel_speed_limit:
        assert (limited == wheels).all()


@given(pairs)
def test_scaling_keeps_the_curvature_and_the_direction_of_the_path(wheels: np.ndarray) -> None:
    (v, omega), (v_limited, omega_limited) = DRIVE.twist(wheels), DRIVE.twist(DRIVE.saturate(wheels, "scale"))
    assert v * omega_limited == pytest.approx(omega * v_limited, abs=1e-11)
    assert v * v_limited >= -1e-15
    assert omega * omega_limited >= -1e-15


def test_clipping_cuts_each_wheel_by_itself() -> None:
    assert DRIVE.saturate(np.array([20.0, 5.0]), "clip").tolist() == [12.5, 5.0]


def test_one_robots_saturation_does_not_slow_another() -> None:
    wheels = np.array([[[25.0, 0.0], [1.0, 2.0]]])
    assert DRIVE.saturate(wheels, "scale").tolist() == [[[12.5, 0.0], [1.0, 2.0]]]


@pytest.mark.parametrize("field", ["wheel_radius", "base_length", "wheel_speed_limit"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_drive_without_size_or_speed_is_refused(field: str, value: float) -> None:
    given_values = {"wheel_radius": 0.016, "base_length": 0.11, "wheel_speed_limit": 12.5, field: value}
    with pytest.raises(ValueError, match=f"{field} must be a positive number"):
        DifferentialDrive(**given_values)
