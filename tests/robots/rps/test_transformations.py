"""The maps between single integrators and unicycles, against their equations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robots.rps.version1 import transformations as first
from robots.rps.version2 import transformations as second

velocities = arrays(np.float64, (2, 3), elements=st.floats(-0.5, 0.5))
poses = arrays(np.float64, (3, 3), elements=st.floats(-3.0, 3.0))
distances = st.floats(0.01, 0.3)


def heading(x: np.ndarray) -> np.ndarray:
    return np.array([np.cos(x[2]), np.sin(x[2])])


@given(velocities, poses, distances)
def test_the_mapping_moves_the_point_ahead_as_wished(u: np.ndarray, x: np.ndarray, distance: float) -> None:
    to_uni, states = second.create_si_to_uni_mapping(distance)
    v, omega = to_uni(u, x)
    step = 1e-6
    moved = x + step * np.array([v * np.cos(x[2]), v * np.sin(x[2]), omega])
    np.testing.assert_allclose((states(moved) - states(x)) / step, u, atol=1e-4 * (1.0 + np.abs(u).max() / distance))


@given(velocities, poses, distances)
def test_both_mappings_are_inverse_to_each_other(u: np.ndarray, x: np.ndarray, distance: float) -> None:
    to_uni, points = second.create_si_to_uni_mapping(distance)
    to_si, axles = second.create_uni_to_si_mapping(distance)
    np.testing.assert_allclose(to_si(to_uni(u, x), x), u, atol=1e-12)
    np.testing.assert_allclose(axles(x, points(x)), x[:2], atol=1e-12)
    np.testing.assert_allclose(first.create_uni_to_si_dynamics(distance)(u, x), to_si(u, x), atol=0.0)


@given(velocities, poses, st.floats(0.1, 5.0))
def test_version_one_cuts_the_turn_of_the_mapping(u: np.ndarray, x: np.ndarray, limit: float) -> None:
    exact = second.create_si_to_uni_mapping(0.05)[0](u, x)
    cut = first.create_si_to_uni_mapping(0.05, limit)[0](u, x)
    np.testing.assert_allclose(cut[0], exact[0])
    np.testing.assert_allclose(cut[1], np.clip(exact[1], -limit, limit))


@given(velocities, poses, st.floats(0.1, 2.0), st.floats(0.0, 5.0))
def test_steering_turns_by_the_angle_to_the_velocity(u: np.ndarray, x: np.ndarray, gain: float, limit: float) -> None:
    v, omega = second.create_si_to_uni_dynamics(gain, limit)(u, x)
    np.testing.assert_allclose(v, gain * (heading(x) * u).sum(axis=0), atol=1e-12)
    turned = np.exp(1j * (x[2] + omega * np.pi / 2.0 / max(limit, 1e-9)))
    if limit > 1e-6:
        np.testing.assert_allclose((np.conj(turned) * (u[0] + 1j * u[1])).imag, 0.0, atol=1e-9)


@given(velocities, poses)
def test_backwards_motion_never_turns_by_more_than_a_right_angle(u: np.ndarray, x: np.ndarray) -> None:
    v, omega = second.create_si_to_uni_dynamics_with_backwards_motion(1.0, np.pi)(u, x)
    assert (np.abs(omega) <= np.pi + 1e-9).all()
    np.testing.assert_allclose(v, (heading(x) * u).sum(axis=0), atol=1e-12)


@pytest.mark.parametrize("module", [first, second])
@given(x=poses)
def test_a_robot_that_wishes_to_stand_does_not_turn(module: object, x: np.ndarray) -> None:
    rest = np.zeros((2, 3))
    for make in ("create_si_to_uni_dynamics", "create_si_to_uni_dynamics_with_backwards_motion"):
        assert (getattr(module, make)()(rest, x) == 0.0).all()


@given(velocities, poses)
def test_version_one_weighs_the_gain_in_the_angle(u: np.ndarray, x: np.ndarray) -> None:
    v, omega = first.create_si_to_uni_dynamics(0.5, 1.0)(u, x)
    left = -np.sin(x[2]) * u[0] + np.cos(x[2]) * u[1]
    far = np.abs(left) > 1e-9
    np.testing.assert_allclose(omega[far], (np.arctan2(left, v + 0.0) / (np.pi / 2.0))[far], atol=1e-6)


def test_wrong_shapes_and_numbers_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match="projection_distance"):
        second.create_si_to_uni_mapping(0.0)
    with pytest.raises(ValueError, match="linear_velocity_gain"):
        second.create_si_to_uni_dynamics(-1.0)
    with pytest.raises(ValueError, match=r"states must have the shape \(3, 2\), got \(2, 2\)"):
        second.create_si_to_uni_dynamics()(np.zeros((2, 2)), np.zeros((2, 2)))
