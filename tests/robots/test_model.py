"""The robot's constants."""

import dataclasses

import numpy as np
import pytest

from robots import GTERNAL
from robots.model import COLLISION_CENTRE, STANDARD_GRAVITY

CHASSIS = GTERNAL.chassis


def test_the_robot_is_the_robotariums() -> None:
    assert (CHASSIS.length, CHASSIS.width, CHASSIS.centre_offset) == (0.10, 0.11, COLLISION_CENTRE)


def test_the_outline_is_the_box_around_its_centre_ahead_of_the_axle() -> None:
    assert CHASSIS.outline.mean(axis=0) == pytest.approx([CHASSIS.centre_offset, 0.0])
    assert np.ptp(CHASSIS.outline, axis=0) == pytest.approx([CHASSIS.length, CHASSIS.width])
    edges = np.roll(CHASSIS.outline, -1, axis=0) - CHASSIS.outline
    turns = edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1)
    assert (turns > 0.0).all(), "counter-clockwise"


def test_the_inertia_is_that_of_the_uniform_box() -> None:
    k = 400
    x, y = ((np.arange(k) + 0.5) / k - 0.5) * CHASSIS.length, ((np.arange(k) + 0.5) / k - 0.5) * CHASSIS.width
    summed = CHASSIS.mass * ((x**2).mean() + (y**2).mean())
    assert CHASSIS.inertia == pytest.approx(summed, rel=1e-5)


def test_traction_is_friction_times_weight() -> None:
    assert CHASSIS.traction_limit == pytest.approx(0.8 * CHASSIS.mass * STANDARD_GRAVITY)


@pytest.mark.parametrize("field", ["length", "width", "mass"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_chassis_without_size_or_mass_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} must be a positive number"):
        dataclasses.replace(CHASSIS, **{field: value})


@pytest.mark.parametrize("field", ["centre_offset", "tyre_friction", "body_friction"])
@pytest.mark.parametrize("value", [-1e-9, np.nan, np.inf])
def test_a_negative_friction_or_offset_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} must be a number that is not negative"):
        dataclasses.replace(CHASSIS, **{field: value})
