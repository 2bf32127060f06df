"""The extended Kalman filter of version 1: its linearisation, and what a measurement does to mean and covariance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.rps.version1.uni_ekf import UnicycleEKF

seeds = st.integers(0, 2**32 - 1)


def made(rng: np.random.Generator) -> UnicycleEKF:
    roots = [rng.normal(0.0, 1.0, (k, k)) for k in (3, 2, 3, 2)]
    p, m, q, r = (root @ root.T + 0.01 * np.eye(len(root)) for root in roots)
    return UnicycleEKF(rng.uniform(-2.0, 2.0, 3), p, 0.105, 0.016, m, q, r)


@given(seeds)
def test_the_transition_is_the_derivative_of_the_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ekf, (v, w), dt = made(rng), rng.uniform(-1.0, 1.0, 2), 0.05
    state, found = ekf.state.copy(), []
    for k in range(3):
        ends = []
        for step in (1e-6, -1e-6):
            ekf.state = state + step * np.eye(3)[k]
            ends.append(ekf.state + ekf.form_fx(v, w, dt)[:, 0])
        found.append((ends[0] - ends[1]) / 2e-6)
    ekf.state = state
    np.testing.assert_allclose(ekf.form_F(v, dt), np.array(found).T, atol=1e-8)


@given(seeds)
def test_a_prediction_moves_the_mean_and_adds_the_noise_of_wheels_and_process(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ekf, (v, w), dt = made(rng), rng.uniform(-1.0, 1.0, 2), 0.05
    before, p, f = ekf.state.copy(), ekf.P.copy(), ekf.form_F(v, dt)
    c, s, half = np.cos(before[2]), np.sin(before[2]), 0.008 * dt
    wheels = np.array([[half * c, half * c], [half * s, half * s], [0.016 / 0.105 * dt, -0.016 / 0.105 * dt]])
    ekf.predict(v, w, dt)
    moved = ekf.state - before - dt * np.array([v * c, v * s, w])
    np.testing.assert_allclose([*moved[:2], np.sin(moved[2])], 0.0, atol=1e-12)
    expected = f @ p @ f.T + wheels @ ekf.wheel_encoder_noise_covariance_matrix @ wheels.T + dt * ekf.Q
    np.testing.assert_allclose(ekf.P, expected, rtol=1e-12)


@given(seeds)
def test_a_place_that_is_measured_weighs_by_information(seed: int) -> None:
    """The posterior of Gaussians: P^-1 + H' R^-1 H, and the mean that both pull to with their information."""
    rng = np.random.default_rng(seed)
    ekf, place, h = made(rng), rng.normal(0.0, 1.0, 2), np.eye(2, 3)
    before, prior, seen = ekf.state.copy(), np.linalg.inv(ekf.P), h.T @ np.linalg.inv(ekf.R_gps) @ h
    ekf.update_gps(place)
    np.testing.assert_allclose(ekf.P @ (prior + seen), np.eye(3), atol=1e-6)
    pulled = prior @ before + h.T @ np.linalg.inv(ekf.R_gps) @ place
    np.testing.assert_allclose((prior + seen) @ ekf.state, pulled, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(ekf.P, ekf.P.T, atol=1e-9)


def test_a_place_without_a_covariance_is_refused() -> None:
    ekf = UnicycleEKF(np.zeros(3), np.eye(3), 0.105, 0.016, np.eye(2), np.eye(3))
    with pytest.raises(ValueError, match="R_gps must be given"):
        ekf.update_gps(np.zeros(2))
