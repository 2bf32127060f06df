"""One control step (sense, law, NID, drive, world) of the paper's six robots, and the theory at size."""

from collections.abc import Callable

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from formation import AngleLaw, SensingGraph, TargetFormation
from robots import World, make_world
from scenarios.definition.experiment import Experiment
from scenarios.simulation.controller import Controller

Target = Callable[[str, float, float, str], None]


def ready(experiment: Experiment, seed: int = 0) -> tuple[World, Controller]:
    """The world at its start and the controller in its first phase."""
    rng = np.random.default_rng(seed)
    world = make_world(
        experiment.plant,
        *experiment.starts.draw(rng),
        nid=experiment.nid,
        robot=experiment.robot,
        saturation=experiment.scenario.robot.saturation,
        arena=experiment.arena,
    )
    controller = Controller(experiment, [rng], ())
    controller.begin_phase(0)
    return world, controller


@pytest.mark.parametrize(
    ("plant", "safety", "at_most"),
    [("pymunk", "none", 60.0), ("saturated", "none", 40.0), ("pymunk", "decentralised", 120.0)],
)
def test_control_step_of_six_robots(
    benchmark: BenchmarkFixture,
    varied: Callable[..., Experiment],
    target: Target,
    plant: str,
    safety: str,
    at_most: float,
) -> None:
    """Over the first 100 periods of the shape experiment, in which the robots drive, turn and touch; the best round,
    because whatever else the machine does only adds to the others. The filter may take as much as all the rest."""
    experiment = varied(f"plant.name={plant}", f"safety.filter={safety}")

    def run(world: World, controller: Controller) -> None:
        for _ in range(100):
            controller.begin_period(world.points, world.headings, 0.033)
            world.step(controller, 0.033)

    benchmark.pedantic(run, setup=lambda: (ready(experiment), {}), rounds=300, warmup_rounds=5)
    target(f"control step, 6 robots, {plant}, filter {safety}", benchmark.stats.stats.min / 100 * 1e6, at_most, "us")


def test_law_of_1000_robots(benchmark: BenchmarkFixture, target: Target) -> None:
    rng = np.random.default_rng(0)
    shape = TargetFormation(SensingGraph.random(1000, rng), rng.uniform(-20.0, 20.0, (1000, 2)))
    law, relative = AngleLaw(shape), rng.normal(size=(1997, 2))
    benchmark(law, relative)
    target("law, 1000 robots", benchmark.stats.stats.min * 1e6, 60.0, "us")


def test_graph_of_100000_agents_is_validated(benchmark: BenchmarkFixture, target: Target) -> None:
    n = 100_000
    edges = np.random.default_rng(1).permutation(SensingGraph.random(n, np.random.default_rng(0)).edges)
    benchmark.pedantic(SensingGraph.from_edges, args=(n, edges), rounds=10, warmup_rounds=1)
    target("graph of 100,000 agents validated", benchmark.stats.stats.min * 1e3, 100.0, "ms")
