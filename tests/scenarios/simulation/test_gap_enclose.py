"""Through a gap and round a leader: what `show` says before, and what becomes of it."""

from pathlib import Path

import numpy as np
import pytest

from formation.plane import as_vectors
from robots.safety import sampling_loss
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.measures.metrics import measure
from scenarios.measures.predictions.remarks import remarks
from scenarios.measures.predictions.way import way
from scenarios.report.cells import chosen
from scenarios.simulation.loop import simulate

NARROW = 0.025
"""Metres that each block is moved in: the gap is 5 cm too narrow."""


def blocks(nearer: float) -> str:
    """The gap's two blocks, each nearer to the middle by some metres."""
    sides = [
        f"{{vertices_m=[[-0.05, {s * (0.18 - nearer)}], [0.2, {s * (0.18 - nearer)}], [0.2, {s}.0], [-0.05, {s}.0]]}}"
        for s in (1, -1)
    ]
    return f"obstacles=[{', '.join(sides)}]"


def test_the_blocks_of_these_tests_are_those_of_the_library() -> None:
    ours, theirs = (open_experiment("gap", changes).arena.obstacles for changes in ((blocks(0.0),), ()))
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(one.vertices, other.vertices)


@pytest.mark.parametrize("name", ["gap", "enclose", "circle", "figure-eight"])
def test_nothing_speaks_against_the_maneuvers_of_the_library(name: str) -> None:
    assert remarks(open_experiment(name), 0) == []


def test_a_gap_that_is_too_narrow_is_told_before_with_time_agent_and_thing() -> None:
    told = remarks(open_experiment("gap", (blocks(NARROW),)), 0)
    assert [line.split(",")[0] for line in told] == ["in the way: obstacle 1", "in the way: obstacle 2"]
    experiment = open_experiment("gap", (blocks(NARROW),))
    found = way(experiment, experiment.initial_points(0))
    assert found is not None
    t, points = found
    near = (experiment.arena.obstacles[0].distance(points) < 0.08 - 1e-9).any(axis=1)
    assert f" from {t[near][0]:.1f} s on" in told[0]


@pytest.mark.parametrize(("nearer", "outcome"), [(0.0, "converged"), (NARROW, "not_converged")])
def test_robots_pass_a_gap_without_contact_and_do_not_call_a_narrower_one_passed(nearer: float, outcome: str) -> None:
    experiment = open_experiment("gap", (blocks(nearer),))
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    assert metrics.outcome == outcome
    if nearer == 0.0:
        loss = sampling_loss(experiment.robot.drive, experiment.nid, experiment.filter_settings, 0.033)
        assert metrics.clearance is not None
        assert metrics.clearance.hulls is not None
        assert metrics.clearance.points.distance.min() > experiment.filter_settings.clearance - loss
        assert metrics.clearance.hulls.distance.min() > 0.0
        assert (trajectory.contact < 0).all()


def test_the_ring_is_closed_when_it_sets_off_and_stays_so() -> None:
    experiment = open_experiment("enclose")
    metrics = measure(experiment, simulate(experiment, 0))
    assert metrics.outcome == "converged"
    assert metrics.settling_time is not None
    assert metrics.settling_time < 15.0


def test_whoever_leaves_its_place_again_has_missed_a_goal_that_asks_to_keep_it() -> None:
    free = ("plant.name=saturated", "safety.filter=none", "obstacles=[]")
    kept = open_experiment("gap", free)
    trajectory = simulate(kept, 0)
    metrics = measure(kept, trajectory)
    assert metrics.outcome == "converged"
    strict = open_experiment("gap", (*free, f"goal.distance_m={0.9 * metrics.tracking.distances.max()}"))
    assert measure(strict, trajectory).outcome == "not_converged"


def test_the_predicted_way_is_that_of_the_ideal_agents(shape: Experiment) -> None:
    ideal = open_experiment("shape", ("plant.name=single_integrator",))
    trajectory, found = simulate(ideal, 0), way(ideal, ideal.initial_points(0))
    assert found is not None
    t, points = found
    measured = [np.interp(t, trajectory.t, trajectory.points[:, 4, axis]) for axis in (0, 1)]
    np.testing.assert_allclose(points[:, 4], np.stack(measured, axis=1), atol=1e-3)


def test_a_way_off_an_open_floor_is_told_with_agent_and_time(tmp_path: Path) -> None:
    text = (LIBRARY / "circle.toml").read_text(encoding="utf-8").replace("walls = true", "walls = false")
    (tmp_path / "wide.toml").write_text(text, encoding="utf-8")
    experiment = open_experiment(str(tmp_path / "wide.toml"), ("reference.width_m=1.9", "reference.period_s=90"))
    (told,) = (line for line in remarks(experiment, 0) if "floor" in line)
    t, points = way(experiment, experiment.initial_points(0)) or (np.zeros(0), as_vectors(np.zeros((0, 6))))
    outside = ~experiment.arena.contains(points)
    beyond = np.flatnonzero(outside.any(axis=1))
    assert told.startswith("in the way: the floor's border, which agent ")
    said = float(told.split(" at ")[1].removesuffix(" s"))
    assert t[beyond[0]] <= said < t[beyond[0]] + 1.0


def test_tables_tell_of_all_phases_or_of_some_up_to_the_last() -> None:
    for count in (1, 5, 12, 13, 100, 720):
        rows = chosen(count)
        assert rows[-1] == count - 1
        assert len(set(rows)) == len(rows) == min(count, 12)
