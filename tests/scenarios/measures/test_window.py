"""Runs with noisy sensors are judged by the mean of each signed angle error over the last ten seconds."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation import wrap
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import judged_end, measure
from scenarios.measures.result import result
from scenarios.measures.window import WINDOW, trailing
from scenarios.simulation.loop import simulate

NOISE = "sensor.position_noise_m=0.01"


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.floats(0.1, 20.0))
def test_the_window_holds_what_the_last_seconds_held(seed: int, samples: int, length: float) -> None:
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(rng.uniform(0.02, 1.0, samples - 1))])
    errors = rng.uniform(-1.5, 1.5, (samples, 3))  # less than pi apart: nothing to unwrap
    window = trailing(t, errors, length)
    for row in range(samples):
        held = errors[(t <= t[row]) & (t > t[row] - length)]
        np.testing.assert_allclose(window.mean[row], held.mean(axis=0), atol=1e-12)
        np.testing.assert_allclose(window.rms[row], np.sqrt((held**2).mean(axis=0)), atol=1e-12)


def test_a_window_of_whole_periods_has_as_many_samples_at_every_time() -> None:
    """Times are rounded: 10 s before one may be a hair off another."""
    t = 0.1 * np.arange(1000)
    beat = np.where(np.arange(1000) % 100 == 0, 1.0, 0.0)[:, None]
    np.testing.assert_allclose(trailing(t, beat, 10.0).mean[100:], 0.01, rtol=1e-9)


@given(st.integers(0, 2**32 - 1), st.floats(-3.0, 3.0))
def test_an_error_about_half_a_turn_does_not_average_to_none(seed: int, off: float) -> None:
    """A mirrored shape shows pi and -pi by turns; any offset of the errors is an offset of their mean."""
    t, noise = np.arange(0.0, 20.0, 0.1), np.random.default_rng(seed).normal(0.0, 0.05, (200, 1))
    centred = trailing(t, noise).mean
    np.testing.assert_allclose(wrap(trailing(t, wrap(noise + np.pi)).mean - centred - np.pi), 0.0, atol=1e-9)
    np.testing.assert_allclose(wrap(trailing(t, wrap(noise + off)).mean - centred - off), 0.0, atol=1e-9)


def test_without_noise_a_run_is_judged_by_its_errors_and_its_result_has_no_window(shape: Experiment) -> None:
    trajectory = simulate(shape, 0)
    metrics = measure(shape, trajectory)
    assert metrics.window is None
    assert (metrics.judged == metrics.error_sum).all()
    assert judged_end(shape, trajectory) == metrics.error_sum[-1]
    assert "window" not in str(result(shape, 0, trajectory, metrics))


@pytest.mark.parametrize("noise", [NOISE, "sensor.bearing_noise_deg=1.0"])
def test_with_noise_outcome_and_settling_are_those_of_the_mean(varied: Callable[..., Experiment], noise: str) -> None:
    experiment = varied(noise, "plant.name=saturated", "safety.filter=none")
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    held = metrics.angle_errors[trajectory.t > trajectory.t[-1] - WINDOW]
    mean = np.abs(held.mean(axis=0)).sum()
    assert metrics.judged[-1] == pytest.approx(mean, abs=1e-12) == float(judged_end(experiment, trajectory))
    assert metrics.outcome == ("converged" if mean < experiment.goal else "not_converged")
    found = result(experiment, 0, trajectory, metrics)
    assert found["settling_time_s"] == metrics.settling_time
    assert found["error_window_s"] == WINDOW
    assert found["mean_angle_error_sum_rad"] == pytest.approx(mean)
    for angle, column in zip(found["angles"], held.T, strict=True):
        assert angle["mean_error_rad"] == pytest.approx(column.mean(), abs=1e-12)
        assert angle["rms_error_rad"] == pytest.approx(np.sqrt((column**2).mean()))
        assert angle["error_rad"] == column[-1]
    if metrics.settling_time is not None:
        settled = trajectory.t >= metrics.settling_time
        assert (metrics.judged[settled] < experiment.goal).all()
        assert not metrics.judged[np.flatnonzero(settled)[0] - 1] < experiment.goal


def test_a_batch_is_judged_as_its_runs_are(varied: Callable[..., Experiment]) -> None:
    experiment = varied(NOISE, "plant.name=saturated", "safety.filter=none", duration=15.0)
    alone = [float(judged_end(experiment, simulate(experiment, seed))) for seed in range(3)]
    np.testing.assert_allclose(judged_end(experiment, simulate(experiment, range(3))), alone, atol=1e-9)


@pytest.mark.parametrize(("asked", "outcome"), [("false", "converged"), ("true", "rejected")])
def test_a_goal_that_asks_for_acceptance_is_missed_by_a_rejected_run(
    varied: Callable[..., Experiment], asked: str, outcome: str
) -> None:
    experiment = varied(f"goal.accepted={asked}", "plant.name=saturated", "safety.filter=none")
    metrics = measure(experiment, simulate(experiment, 0))
    assert not metrics.verdict.accepted
    assert metrics.outcome == outcome
    accepted = varied(f"goal.accepted={asked}", "plant.name=saturated")
    assert measure(accepted, simulate(accepted, 0)).outcome == "converged"
