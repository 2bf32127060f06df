"""What is found of runs while they go on, however long the chunks are in which their states pass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.online.watch import Achieved, Watch
from scenarios.simulation.compiled.runs import Runs

SEEDS = tuple(range(5))
PLANTS = ("single_integrator", "unicycle", "saturated")


def achieved(of: Experiment, most: int, seeds: Sequence[int] = SEEDS) -> list[Achieved | None]:
    """Of the seeds, looked at in chunks of ``most`` states."""
    runs = Runs(of, seeds)
    watch = Watch(of, runs.state)
    for chunk in runs.advance(most):
        watch.take(chunk)
    return watch.achieved()


@pytest.mark.parametrize("case", range(9))
def test_a_long_chunk_tells_what_each_of_its_states_would(case: int) -> None:
    """The last state of a chunk may stand for all only where robots cannot have gone far enough to change a thing."""
    rng = np.random.default_rng(case)
    wide, high = rng.uniform(0.7, 1.7), rng.uniform(0.7, 1.1)  # some starts are off the floor, some soon leave it
    of = open_experiment(
        str(rng.choice(["shape", "maneuver", "scale-only"])),
        (
            f"plant.name='{PLANTS[case % 3]}'",
            f"safety.filter='{rng.choice(['none', 'decentralised'])}'",
            f"random_start.x_m=[{-wide:.2f}, {wide:.2f}]",
            f"random_start.y_m=[{-high:.2f}, {high:.2f}]",
            "random_start.min_separation_m=0.12",
            f"robot.projection_distance_m={rng.choice([0.025, 0.05])}",
            f"goal.angle_error_sum_rad={rng.choice([0.01, 0.3, 2.0])}",
        ),
        float(rng.uniform(5.0, 30.0)),
    )
    each = achieved(of, 1)
    assert each == achieved(of, 16) == achieved(of, 4000)


def test_an_axle_that_is_off_the_floor_in_the_midst_of_a_chunk_is_found() -> None:
    """With seed 4, the farthest robot goes to x = 1.10 m and comes back to 1.01 m."""
    start = ("random_start.x_m=[-0.9, 0.9]", "random_start.y_m=[-0.7, 0.7]")
    of = open_experiment("shape", ("plant.name='saturated'", "safety.filter='none'", *start, "arena.x_m=[-1.06, 1.06]"))
    [found] = achieved(of, 4000, seeds=[4])
    assert found is not None
    assert "floor" in found.violations
