"""What the events' scenarios show, run by run, in `pymunk` with the safety filter.

The number of seeds is EVIDENCE_SEEDS, at most 100. Some minutes for all of them, which print what they found:
``EVIDENCE_SEEDS=100 pytest -s -m slow tests/evidence/test_events.py``.
"""

import os
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate

SEEDS = min(100, int(os.environ.get("EVIDENCE_SEEDS", "4")))

pytestmark = pytest.mark.slow

Job = tuple[str, int, tuple[str, ...]]


def run(job: Job) -> dict[str, object]:
    name, seed, changes = job
    experiment = open_experiment(name, changes)
    trajectory = simulate(experiment, seed)
    return result(experiment, seed, trajectory, measure(experiment, trajectory))


def runs(name: str, seeds: int, *changes: str) -> list[dict[str, object]]:
    with ProcessPoolExecutor(2) as pool:
        return list(pool.map(run, [(name, seed, changes) for seed in range(seeds)]))


def test_reshape_reaches_its_goal_in_every_run() -> None:
    found = runs("reshape", SEEDS)
    print("closest (m):", min(each["min_separation"]["distance_m"] for each in found))  # type: ignore[index]
    assert [each["outcome"] for each in found] == ["converged"] * SEEDS
    assert all(each["contacts"]["first"] is None for each in found)  # type: ignore[index]


def test_a_stopped_robot_takes_the_others_as_far_off_as_predicted_within_5_percent() -> None:
    worst = 0.0
    for each in runs("robot-stops", SEEDS):
        offsets = each["events"][0]["offsets_m"]  # type: ignore[index]
        predicted, measured = np.array(offsets["predicted"]), np.array(offsets["measured"])
        off = predicted > 0.01
        worst = max(worst, float(np.abs(measured[off] / predicted[off] - 1.0).max()))
        assert each["outcome"] == "converged"
    print(f"largest relative difference: {worst:.4f}")
    assert worst < 0.05


def test_other_pairs_converge_where_holding_still_does_not() -> None:
    pairs, still = runs("lost-edges", SEEDS), runs("lost-edges", SEEDS, 'law.without_neighbour="hold-still"')
    settled = [each["settling_time_s"] for each in pairs]
    print("settled after (s), quartiles:", np.percentile(settled, [0, 25, 50, 75, 100]).round(1).tolist())
    assert [each["outcome"] for each in pairs] == ["converged"] * SEEDS
    assert [each["outcome"] for each in still] == ["not_converged"] * SEEDS


@pytest.mark.parametrize("loss", [0.2, 0.5])
def test_random_loss_of_edges_delays_the_paper_s_shape_and_no_more(loss: float) -> None:
    changes = (f"sensor.edge_loss={loss}", "duration_s=240.0")
    for choice in ("hold-still", "another-pair"):
        found = runs("shape", SEEDS, *changes, f'law.without_neighbour="{choice}"')
        settled = [each["settling_time_s"] for each in found]
        print(f"loss {loss:g}, {choice}: settled after (s) {np.median(settled):.1f}")  # type: ignore[arg-type]
        assert [each["outcome"] for each in found] == ["converged"] * SEEDS
