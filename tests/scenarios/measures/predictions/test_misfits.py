"""Ends at which the robots do not fit are told before anything moves."""

import numpy as np
import pytest

from formation import end_configuration
from robots.testbed import COLLISION_DISTANCE
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.predictions.misfits import misfits

LEADER = np.array([0.0, 0.5])


def start(experiment: Experiment, spread: float) -> np.ndarray:
    """The start of `shape` with agents 1 and 2 ``spread`` apart: they fix the scale of the end."""
    points = experiment.initial_points(0)
    direction = (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
    points[1] = points[0] + spread * direction
    return points


def closest_at_end(experiment: Experiment, points: np.ndarray) -> float:
    end = end_configuration(experiment.target, points[0], points[1])
    gaps = np.linalg.norm(end[:, None] - end, axis=-1)
    return float(gaps[np.triu_indices(len(end), 1)].min())


def spread_for(experiment: Experiment, closest: float) -> float:
    """How far apart agents 1 and 2 start where the closest two end ``closest`` apart."""
    return closest / closest_at_end(experiment, start(experiment, 1.0))


@pytest.mark.parametrize("closer", [0.9, 0.999])
def test_an_end_that_the_testbed_rejects_is_told_with_the_pair_and_its_distance(closer: float) -> None:
    experiment = open_experiment("shape")
    (told,) = misfits(experiment, start(experiment, spread_for(experiment, closer * COLLISION_DISTANCE)))
    assert told.startswith("phase shape ends with agents ")
    assert f"{closer * COLLISION_DISTANCE:.3f} m apart: the testbed rejects less than 0.135 m" in told


def test_an_end_tighter_than_the_filter_allows_is_told_where_there_is_such_a_filter() -> None:
    for safety, words in (("decentralised", ["the safety filter keeps 0.155 m"]), ("none", [])):
        experiment = open_experiment("shape", (f"safety.filter={safety}",))
        told = misfits(experiment, start(experiment, spread_for(experiment, 0.15)))
        assert [text.split(": ")[1] for text in told] == words


def test_what_fits_is_not_mentioned() -> None:
    experiment = open_experiment("shape")
    assert misfits(experiment, start(experiment, spread_for(experiment, 0.156))) == []
    assert misfits(open_experiment("maneuver-testbed"), open_experiment("maneuver-testbed").initial_points(0)) == []


def test_every_phase_that_ends_off_the_floor_is_told() -> None:
    experiment = open_experiment("maneuver")
    told = misfits(experiment, experiment.initial_points(0))
    assert [text.split(" ")[1] for text in told] == ["translate", "turn", "shrink"]
    assert all(text.endswith("off the floor") for text in told)


def test_an_end_in_an_obstacle_is_told_with_agent_and_obstacle() -> None:
    disc = "obstacles=[{vertices_m=[[5.0, 5.0]], radius_m=0.1}, {vertices_m=[[0.5, 0.0]], radius_m=0.1}]"
    experiment = open_experiment("shape", (disc,))
    (told,) = misfits(experiment, experiment.initial_points(0))
    assert told == "phase shape ends with agent 3 at (0.5, 0) m: less than 0.0675 m from obstacle 2"


@pytest.mark.parametrize(("scenario", "change"), [("maneuver", "plant.name=single_integrator"), ("own-law", "")])
def test_points_and_laws_without_a_prediction_have_nothing_to_fit(scenario: str, change: str) -> None:
    experiment = open_experiment(scenario, (change,) if change else ())
    assert misfits(experiment, start(experiment, 0.01)) == []
