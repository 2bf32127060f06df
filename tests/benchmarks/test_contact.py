"""The contact world at size: what it costs beside the solver alone."""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture

from formation import AngleLaw, SensingGraph, TargetFormation
from robots import GTERNAL, NearIdentityDiffeomorphism, RelativePositionSensor
from robots.worlds.contact import SUBSTEPS, Contact

PERIOD = 0.033


def test_control_step_of_1000_robots_beside_the_solver_alone(
    benchmark: BenchmarkFixture, target: Callable[[str, float, float, str], None]
) -> None:
    """A whole control step (sense, law, NID, drive, world) against bare ``Space.step`` calls of the same world, joints
    and shapes included, at the same substeps. The two take turns, so that both see the same machine."""
    n, rng, nid = 1000, np.random.default_rng(0), NearIdentityDiffeomorphism(0.025)
    grid = 0.3 * np.stack(np.meshgrid(np.arange(40), np.arange(25)), axis=-1).reshape(-1, 2)
    world = Contact(nid.poses(grid, rng.uniform(-np.pi, np.pi, n)), nid, GTERNAL)
    graph = SensingGraph.random(n, rng)
    law = AngleLaw(TargetFormation(graph, rng.uniform(-5.0, 5.0, (n, 2))))
    sensor = RelativePositionSensor(graph.edges)

    def control(points: np.ndarray, headings: np.ndarray, elapsed: float) -> np.ndarray:
        return law(sensor.measure(points, headings))

    whole, bare = [], []

    def step() -> None:
        begun = perf_counter()
        world.step(control, PERIOD)
        whole.append(perf_counter() - begun)
        begun = perf_counter()
        for _ in range(SUBSTEPS):
            world.space.step(PERIOD / SUBSTEPS)
        bare.append(perf_counter() - begun)

    benchmark.pedantic(step, rounds=100, warmup_rounds=5)
    benchmark.extra_info["bare_solver_us"] = median(bare) * 1e6
    target("control step, 1000 robots, pymunk, / bare Space.step", median(whole) / median(bare), 2.5, "times")
