"""Twenty robots at once: swapping places on a circle, and in random leader-first-follower formations."""

from __future__ import annotations

import os

import numpy as np
import pytest

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism, make_world
from robots.obstacles import Obstacle, disc
from robots.safety import FilterSettings, make_filter
from robots.testbed import collision_centres, separation
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.safety_result import deadlocks
from scenarios.simulation.loop import simulate

pytestmark = pytest.mark.slow

SEEDS = min(20, int(os.environ.get("EVIDENCE_SEEDS", "3")))
NID = NearIdentityDiffeomorphism(0.025)
N, PERIOD, ARRIVED = 20, 0.033, 0.02
CONTACT = 2.0 * GTERNAL.chassis.radius
DISCS = (
    disc((0.0, 0.0), 0.15),
    disc((0.5, 0.1), 0.1),
    disc((-0.4, 0.35), 0.12),
    disc((-0.3, -0.5), 0.1),
    disc((0.35, -0.45), 0.08),
)


def swap(seed: int, radius: float, obstacles: tuple[Obstacle, ...], seconds: float = 180.0) -> tuple[np.ndarray, ...]:
    """Robots on a circle drive to the opposite place, at 0.2 m/s at most: poses, distances, stuck times."""
    angle = 2.0 * np.pi * np.arange(N) / N
    start = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    theta = np.random.default_rng(seed).uniform(-np.pi, np.pi, N)
    arena = Arena((-3.0, 3.0), (-3.0, 3.0), False, obstacles)
    world = make_world("pymunk", start, theta, nid=NID, robot=GTERNAL, arena=arena)
    safety = make_filter("decentralised", (N,), GTERNAL.drive, NID, FilterSettings(), arena)

    def controller(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
        away = -start - points
        away *= np.minimum(1.0, 0.2 / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9))
        body = (away.view(np.complex128) * np.conj(headings.view(np.complex128))).view(np.float64)
        return safety.filter(points, headings, body, np.zeros((N, 2)), PERIOD)

    poses = [world.poses.copy()]
    for _ in range(int(seconds / PERIOD)):
        world.step(controller, PERIOD)
        poses.append(world.poses.copy())
        distance = np.linalg.norm(world.points + start, axis=1)
        if (distance < ARRIVED).all():
            break
    return np.array(poses), distance, safety.stuck


@pytest.mark.parametrize("discs", [(), DISCS], ids=["free", "five discs"])
@pytest.mark.parametrize("seed", range(SEEDS))
def test_twenty_robots_swap_places_without_contact(discs: tuple[Obstacle, ...], seed: int) -> None:
    poses, distance, stuck = swap(seed, 1.2 if discs else 1.0, discs)
    centres = collision_centres(poses)
    closest = separation(centres).distance.min()
    print(f"swap, {len(discs)} discs, seed {seed}: {PERIOD * len(poses):.1f} s, closest {closest:.4f} m")
    assert closest >= CONTACT
    assert all(obstacle.distance(centres).min() >= CONTACT / 2.0 for obstacle in discs)
    assert (stuck[distance >= ARRIVED] >= FilterSettings().stuck_time).all()


def formation(seed: int, *more: str) -> Experiment:
    """Twenty robots on a random graph with a random target that holds them, sent to the target's own scale."""
    changes = (
        "safety.filter=decentralised",
        "random_formation.agents=20",
        f"random_formation.seed={seed}",
        "random_formation.radius_m=1.5",
        "random_formation.min_separation_m=0.35",
        "random_start={x_m=[-1.5, 1.5], y_m=[-1.5, 1.5], min_separation_m=0.25}",
        *more,
    )
    x, y = np.subtract(*open_experiment("random-50", changes).target.positions[[1, 0]])
    return open_experiment("random-50", (*changes, f"phases.1.displacement_m=[{x}, {y}]"))


def among_discs(seed: int) -> Experiment:
    """The same with five discs that stand on no robot's place at the end."""
    free, rng = formation(seed), np.random.default_rng(seed)
    leader = free.initial_points(seed)[0]
    end = leader + free.target.positions - free.target.positions[0]
    found: list[tuple[np.ndarray, float]] = []
    while len(found) < 5:
        centre, radius = end.mean(axis=0) + rng.uniform(-1.5, 1.5, 2), rng.uniform(0.06, 0.15)
        apart = all(np.linalg.norm(centre - other) > radius + wide + 0.35 for other, wide in found)
        if apart and np.linalg.norm(np.vstack([end, leader]) - centre, axis=1).min() > radius + 0.12:
            found.append((centre, radius))
    discs = ", ".join(f"{{vertices_m=[[{x}, {y}]], radius_m={radius}}}" for (x, y), radius in found)
    return formation(seed, f"obstacles=[{discs}]")


@pytest.mark.parametrize("build", [formation, among_discs])
@pytest.mark.parametrize("seed", range(SEEDS))
def test_twenty_robots_form_a_random_shape_without_contact(build, seed: int) -> None:
    experiment = build(seed)
    trajectory = simulate(experiment, seed)
    metrics = measure(experiment, trajectory)
    open_deadlocks = [d for d in deadlocks(trajectory, FilterSettings().stuck_time) if d["until_s"] is None]
    closest = metrics.separation.distance.min()
    print(
        f"{build.__name__}, seed {seed}: {metrics.outcome}, settled {metrics.settling_time}, closest {closest:.4f} m, "
        f"unbroken deadlocks {len(open_deadlocks)}"
    )
    assert closest >= CONTACT
    centres = collision_centres(trajectory.poses)
    assert all(o.distance(centres).min() >= CONTACT / 2.0 for o in experiment.arena.obstacles)
    assert metrics.outcome == "converged" or open_deadlocks
