"""Monte Carlo evidence for the safety filter. ``make evidence`` runs it over all seeds and prints what it found.

The number of seeds is EVIDENCE_SEEDS, 500 in `make evidence`.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import pytest

from robots import GTERNAL
from robots.safety import FilterSettings
from robots.testbed import COLLISION_DISTANCE, collision_centres, separation
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.tracking import predicted_ends
from scenarios.simulation.loop import simulate

SEEDS = int(os.environ.get("EVIDENCE_SEEDS", "12"))

pytestmark = pytest.mark.slow

FLOOR_STARTS = "random_start={x_m=[-1.5, 1.5], y_m=[-0.9, 0.9], min_separation_m=0.2}"
LEGAL_STARTS = f"random_start={{x_m=[-1.5, 1.5], y_m=[-0.9, 0.9], min_separation_m={COLLISION_DISTANCE}}}"
DISTURBED = (
    "sensor.position_noise_m=0.01",
    "sensor.bearing_noise_deg=1.0",
    "sensor.delay_periods=1",
    "robot.tyre_friction=0.4",
)


@dataclass(frozen=True)
class Run:
    """What one seed came to; distances in metres.

    Attributes:
        closest: two robots at any time.
        tightest_end: two places at the end of any phase, as the theory predicts it.
    """

    seed: int
    outcome: str
    settling_time: float | None
    closest: float
    tightest_end: float
    began_in_contact: bool
    contact: bool
    accepted: bool
    relaxed: int
    problems: int
    deadlocked: bool


def runs(scenario: str, *changes: str, seeds: int = SEEDS) -> list[Run]:
    """Every seed of a scenario."""
    experiment = open_experiment(scenario, changes)
    return [one(experiment, seed) for seed in range(seeds)]


def one(experiment: Experiment, seed: int) -> Run:
    trajectory = simulate(experiment, seed)
    metrics = measure(experiment, trajectory)
    return Run(
        seed=seed,
        outcome=metrics.outcome,
        settling_time=metrics.settling_time,
        closest=float(metrics.separation.distance.min()),
        tightest_end=float(separation(predicted_ends(experiment, trajectory.points[0])).distance.min()),
        began_in_contact=touched(trajectory.poses[:1]),
        contact=touched(trajectory.poses),
        accepted=metrics.verdict.accepted,
        relaxed=int((trajectory.relaxation > 0.0).sum()),
        problems=trajectory.relaxation.size,
        deadlocked=bool((trajectory.stuck >= experiment.filter_settings.stuck_time).any()),
    )


def touched(poses: np.ndarray) -> bool:
    """Whether two chassis overlap in any recorded state (T, n, 3): separating axes of every pair near enough."""
    centres = collision_centres(poses)
    a, b = np.triu_indices(poses.shape[1], 1)
    near = np.argwhere(np.linalg.norm(centres[:, a] - centres[:, b], axis=-1) < 2.0 * GTERNAL.chassis.radius)
    return any(overlap(poses[t, a[pair]], poses[t, b[pair]]) for t, pair in near)


def overlap(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two chassis at poses (3,) overlap: no side of either separates them."""
    corners = []
    for x, y, theta in (one, other):
        c, s = np.cos(theta), np.sin(theta)
        corners.append(GTERNAL.chassis.outline @ np.array([[c, s], [-s, c]]) + [x, y])
    for theta in (one[2], one[2] + np.pi / 2, other[2], other[2] + np.pi / 2):
        first, second = (p @ [np.cos(theta), np.sin(theta)] for p in corners)
        if first.max() <= second.min() or second.max() <= first.min():
            return False
    return True


def report(name: str, found: list[Run]) -> None:
    settled = [r.settling_time for r in found if r.settling_time is not None]
    median = f"median settling {np.median(settled):.2f} s" if settled else "none settled"
    line = (
        f"{name}: {sum(r.outcome == 'converged' for r in found)} of {len(found)} converged, "
        f"{median}, closest {min(r.closest for r in found):.4f} m, "
        f"{sum(r.contact for r in found)} with contact, "
        f"{sum(r.closest < COLLISION_DISTANCE for r in found)} too close, "
        f"{sum(r.accepted for r in found)} accepted, {sum(r.relaxed for r in found)} of "
        f"{sum(r.problems for r in found)} problems relaxed, {sum(r.deadlocked for r in found)} with deadlocks, "
        f"missed: {[r.seed for r in found if r.outcome != 'converged']}"
    )
    print(line)


@pytest.mark.parametrize("scenario", ["shape", "maneuver", "maneuver-testbed"])
def test_every_heading_seed_converges_without_contact(scenario: str) -> None:
    found = runs(scenario)
    report(scenario, found)
    assert all(r.outcome == "converged" for r in found)
    assert not any(r.contact for r in found)
    assert min(r.closest for r in found) >= COLLISION_DISTANCE
    assert sum(r.relaxed for r in found) <= 1e-3 * sum(r.problems for r in found)
    if scenario == "maneuver-testbed":
        assert all(r.accepted for r in found)


@pytest.mark.parametrize("scenario", ["shape", "maneuver"])
def test_random_starts_on_the_floor_converge(scenario: str) -> None:
    found = runs(scenario, FLOOR_STARTS)
    report(f"{scenario}, random starts", found)
    assert sum(r.outcome != "converged" for r in found) <= SEEDS // 500
    assert not any(r.contact for r in found)


@pytest.mark.parametrize("scenario", ["shape", "maneuver"])
def test_every_start_that_the_testbed_accepts_converges_if_robots_fit_on_the_places_of_its_end(scenario: str) -> None:
    """Agents 1 and 2 fix the size of the shape: from too near, the theory itself ends closer than the filter allows."""
    found = runs(scenario, LEGAL_STARTS)
    fits = [r for r in found if r.tightest_end >= FilterSettings().safe_distance]
    report(f"{scenario}, legal starts, {len(fits)} with an end that fits", found)
    for r in found:
        if r.outcome != "converged":
            print(f"seed {r.seed} missed: places of its end are {r.tightest_end:.4f} m apart")
    assert sum(r.outcome != "converged" for r in fits) <= SEEDS // 500
    assert not any(r.contact and not r.began_in_contact for r in found)
    assert min(r.closest for r in found) >= COLLISION_DISTANCE


def test_the_filter_costs_at_most_a_quarter_of_the_settling_time() -> None:
    medians = []
    for safety in ("none", "decentralised"):
        found = runs("shape", "plant.name=saturated", f"safety.filter={safety}")
        report(f"shape, saturated, {safety}", found)
        medians.append(np.median([r.settling_time for r in found if r.settling_time is not None]))
    print(f"ratio {medians[1] / medians[0]:.3f}")
    assert medians[1] <= 1.25 * medians[0]


@pytest.mark.parametrize("scenario", ["shape", "maneuver"])
def test_noise_delay_and_halved_friction_bring_no_contact(scenario: str) -> None:
    found = runs(scenario, *DISTURBED, seeds=min(SEEDS, 100))
    report(f"{scenario}, noise, delay, half the friction", found)
    assert not any(r.contact for r in found)
