"""result.json."""

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from robots import NearIdentityDiffeomorphism
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate

KEYS = {
    "schema_version",
    "scenario",
    "scenario_sha256",
    "seed",
    "plant",
    "safety",
    "versions",
    "angles",
    "angle_error_sum_rad",
    "axle_angle_error_sum_rad",
    "settling_time_s",
    "min_separation",
    "testbed",
    "phases",
    "outcome",
}


def summary(experiment: Experiment, seed: int = 0) -> dict:
    run = simulate(experiment, seed)
    return result(experiment, seed, run, measure(experiment, run))


def test_a_result_holds_what_comparisons_read(shape: Experiment) -> None:
    found = summary(shape, 3)
    assert set(found) >= KEYS
    assert (found["scenario"], found["seed"], found["plant"]) == ("shape", 3, "pymunk")
    assert found["scenario_sha256"] == shape.file.sha256
    assert found["outcome"] == "converged"
    assert [angle["name"] for angle in found["angles"]] == shape.angles.names
    errors = [abs(angle["error_rad"]) for angle in found["angles"]]
    assert sum(errors) == pytest.approx(found["angle_error_sum_rad"], abs=1e-15)


def test_a_final_angle_is_its_target_plus_its_error_within_one_turn(shape: Experiment) -> None:
    for angle in summary(shape)["angles"]:
        assert 0.0 <= angle["final_deg"] < 360.0
        expected = angle["target_deg"] + np.degrees(angle["error_rad"])
        assert np.sin(np.radians(angle["final_deg"] - expected) / 2.0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "saturated", "pymunk"])
def test_a_result_is_json_and_agents_are_numbered_from_1(varied: Callable[..., Experiment], plant: str) -> None:
    found = json.loads(json.dumps(summary(varied(f"plant.name={plant}", duration=3.0)), allow_nan=False))
    named = [
        *found["min_separation"]["agents"],
        *(a for v in found["testbed"]["violations"] for a in v["first"]["agents"]),
    ]
    assert all(1 <= agent <= 6 for agent in named)


@pytest.mark.parametrize("plant", ["unicycle", "pymunk"])
def test_a_diverged_run_is_an_outcome_that_json_can_hold(varied: Callable[..., Experiment], plant: str) -> None:
    nearly_singular = NearIdentityDiffeomorphism(1e-310)
    experiment = varied(f"plant.name={plant}", "safety.filter=none", duration=1.0)
    experiment = replace(experiment, fleet=replace(experiment.fleet, nid=nearly_singular))
    found = json.loads(json.dumps(summary(experiment), allow_nan=False))
    assert found["outcome"] == "diverged"
    assert found["testbed"]["accepted"] is False
    assert found["settling_time_s"] is None
