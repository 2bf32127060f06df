"""Maneuvers over many seeds: the gap, the ring, and how far the shape lags on curves with robots and filter."""

from __future__ import annotations

import os

import numpy as np
import pytest

from formation.plane import as_complex
from formation.references.lag import shape_residual
from robots.safety import sampling_loss
from scenarios.definition.experiment import open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.predictions.course import course
from scenarios.simulation.loop import simulate

pytestmark = pytest.mark.slow

SEEDS = min(100, int(os.environ.get("EVIDENCE_SEEDS", "2")))
ALLOWED = 0.16
"""m/s that the outermost robot needs at most, for the lag on curves to be promised."""


@pytest.mark.parametrize("name", ["gap", "enclose"])
def test_everyone_passes_without_contact_and_keeps_its_clearance(name: str) -> None:
    experiment = open_experiment(name)
    settings, period = experiment.filter_settings, experiment.scenario.plant.control_period_s
    least = settings.clearance - sampling_loss(experiment.robot.drive, experiment.nid, settings, period)
    found = []
    for seed in range(SEEDS):
        trajectory = simulate(experiment, seed)
        metrics = measure(experiment, trajectory)
        assert metrics.outcome == "converged", f"seed {seed}"
        assert (trajectory.contact < 0).all(), f"seed {seed}"
        assert metrics.clearance is not None
        assert metrics.clearance.hulls is not None
        found.append((metrics.clearance.points.distance.min(), metrics.clearance.hulls.distance.min()))
    points, hulls = np.min(found, axis=0)
    print(f"{name}: {SEEDS} of {SEEDS}; least clearance of a point {points:.4f} m, of a hull {hulls:.4f} m")
    assert points > least
    assert hulls > 0.0


@pytest.mark.parametrize(
    ("name", "period", "rounds"), [("circle", 45.0, 2), ("circle", 35.0, 3), ("figure-eight", 92.0, 2)]
)
def test_robots_with_filter_lag_no_further_than_it_is_told(name: str, period: float, rounds: int) -> None:
    experiment = open_experiment(name, (f"reference.period_s={period}",), rounds * period)
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.lag is not None
    assert known.speed.max() <= ALLOWED
    worst = 0.0
    for seed in range(SEEDS):
        trajectory = simulate(experiment, seed)
        late = trajectory.t >= trajectory.t[-1] - period / 2.0
        worst = max(worst, float(shape_residual(experiment.target, as_complex(trajectory.points[late])).max()))
    print(f"{name}, {period:g} s: {SEEDS} seeds, largest residual {worst:.6f}, told {known.lag[0]:.6f}")
    assert worst <= known.lag[0]


@pytest.mark.parametrize("omega", [0.1, 0.2, 0.3, 0.4, 0.5])
@pytest.mark.parametrize("name", ["circle", "figure-eight"])
def test_ideal_agents_follow_exactly_with_feed_forward_and_as_predicted_without(name: str, omega: float) -> None:
    def residual(*changes: str, cycle: float = 0.0) -> float:
        changed = ("plant.name=single_integrator", f"reference.period_s={2.0 * np.pi / omega}", *changes)
        trajectory = simulate(open_experiment(name, changed, 80.0), 0)
        late = trajectory.t >= 80.0 - cycle
        return float(shape_residual(experiment.target, as_complex(trajectory.points[late])).max())

    experiment = open_experiment(
        name, ("plant.name=single_integrator", f"reference.period_s={2.0 * np.pi / omega}", "law.feedforward=false")
    )
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.lag is not None
    free, told = residual("law.first_follower=stationary"), residual()
    behind = residual("law.feedforward=false", cycle=2.0 * np.pi / omega)
    orders = [residual(f"plant.control_period_s={h}") for h in (0.04, 0.08)]
    print(
        f"{name}, {omega:g} rad/s: without compass {free:.1e}, displacement {told:.1e}, order "
        f"{np.log2(orders[1] / orders[0]):.2f}, without feed-forward {behind:.4f}, predicted {known.lag[0]:.4f}"
    )
    assert free < 1e-12
    assert told < 1e-8
    assert behind == pytest.approx(known.lag[0], rel=0.01)
