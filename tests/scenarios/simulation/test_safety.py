"""The safety filter as scenarios ask for it, and what a run says about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from robots import GTERNAL
from robots.testbed import collision_centres, separation
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.measures.safety_result import deadlocks
from scenarios.measures.tracking import predicted_ends
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

NOISE = ("sensor.position_noise_m=0.01", "sensor.bearing_noise_deg=1.0")
DISC = "obstacles=[{vertices_m=[[0.3, 0.0]], radius_m=0.1}]"


def run(*changes: str, scenario: str = "shape", seed: int = 0, duration: float = 2.0) -> Trajectory:
    return simulate(open_experiment(scenario, changes, duration), seed)


@pytest.mark.parametrize("scenario", ["shape", "maneuver", "maneuver-testbed"])
def test_the_papers_experiments_run_with_the_decentralised_filter(scenario: str) -> None:
    assert open_experiment(scenario).safety == "decentralised"


def test_points_need_no_filter() -> None:
    assert open_experiment("shape", ("plant.name=single_integrator",)).safety == "none"


@pytest.mark.parametrize("plant", ["unicycle", "saturated", "pymunk"])
@pytest.mark.parametrize("filter_name", ["decentralised", "centralised", "robotarium"])
def test_every_filter_runs_on_every_plant_with_robots(plant: str, filter_name: str) -> None:
    trajectory = run(f"plant.name={plant}", f"safety.filter={filter_name}", *NOISE, DISC)
    assert np.isfinite(trajectory.poses).all()
    assert trajectory.intervention.any()


def test_without_a_filter_nothing_is_recorded_as_changed() -> None:
    trajectory = run("safety.filter=none")
    assert not trajectory.intervention.any()
    assert not trajectory.relaxation.any()
    assert not trajectory.stuck.any()
    assert (trajectory.blockers == -1).all()


@pytest.mark.parametrize("scenario", ["shape", "maneuver"])
def test_same_seed_same_run_bit_for_bit(scenario: str) -> None:
    one, two = (run(*NOISE, "sensor.delay_periods=2", scenario=scenario, seed=7) for _ in range(2))
    np.testing.assert_array_equal(one.poses, two.poses)
    np.testing.assert_array_equal(one.intervention, two.intervention)


@pytest.mark.parametrize("filter_name", ["decentralised", "centralised", "robotarium"])
def test_a_batch_equals_its_single_runs(filter_name: str) -> None:
    changes = ("plant.name=saturated", f"safety.filter={filter_name}", "sensor.delay_periods=1", *NOISE)
    experiment = open_experiment("maneuver", changes, 3.0)
    batch = simulate(experiment, [3, 4])
    for row, seed in enumerate((3, 4)):
        single = simulate(experiment, seed)
        np.testing.assert_array_equal(batch.run(row).poses, single.poses)
        np.testing.assert_array_equal(batch.run(row).intervention, single.intervention)


def test_a_delay_shifts_what_robots_do_by_as_many_periods() -> None:
    """While a robot stands still a delay changes nothing; the first command follows the first measurement at once."""
    prompt, late = (
        run("plant.name=unicycle", f"sensor.delay_periods={k}", 'sensor.own_motion="unknown"') for k in (0, 3)
    )
    np.testing.assert_array_equal(late.wheel_speeds[1], prompt.wheel_speeds[1])
    for row in (2, 3, 4):
        np.testing.assert_array_equal(late.wheel_speeds[row], prompt.wheel_speeds[1])
    assert not np.array_equal(late.wheel_speeds[5], prompt.wheel_speeds[1])


def test_obstacles_are_avoided_and_touching_one_is_a_violation() -> None:
    for safety, kinds in (("decentralised", set()), ("none", {"obstacle"})):
        experiment = open_experiment("shape", (DISC, f"safety.filter={safety}"))
        metrics = measure(experiment, simulate(experiment))
        found = {v.kind for v in metrics.verdict.violations}
        assert found & {"obstacle"} == kinds
    assert metrics.outcome in ("converged", "not_converged")


def test_random_starts_keep_clear_of_obstacles() -> None:
    experiment = open_experiment("shape", ("random_start={}", "obstacles=[{vertices_m=[[0, 0]], radius_m=0.6}]"))
    for seed in range(20):
        assert (experiment.arena.obstacles[0].distance(experiment.initial_points(seed)) >= 0.08).all()


def test_the_result_names_agents_and_rows_of_infeasible_problems() -> None:
    agents = "agents.3.start=[-0.43, 0.03]"  # between agents 2 and 4, nearer than the safe distance to both
    experiment = open_experiment("shape", (agents, "agents.4.start=[-0.36, 0.06]"), 1.0)
    trajectory = simulate(experiment)
    summary = result(experiment, 0, trajectory, measure(experiment, trajectory))
    relaxed = summary["relaxed"]
    assert relaxed["count"] == int((trajectory.relaxation > 0.0).sum()) > 0
    assert relaxed["of"] == 6 * (len(trajectory.t) - 1)
    squeezed = next(entry for entry in relaxed["agents"] if entry["agent"] == 3)
    assert set(squeezed["first"]["rows"]) == {"agent 2", "agent 4"}
    assert 0.0 < squeezed["largest_m_s"] <= relaxed["largest_m_s"]
    assert summary["safety"] == "decentralised"


def test_deadlocks_have_a_beginning_and_an_end() -> None:
    trajectory = run(duration=1.0)
    stuck = np.zeros_like(trajectory.stuck)
    stuck[5:9, 2] = 2.5
    stuck[20:, 4] = 3.0
    changed = replace(trajectory, stuck=stuck)
    t = trajectory.t
    assert deadlocks(changed, 2.0) == [
        {"agent": 3, "from_s": float(t[5]), "until_s": float(t[9])},
        {"agent": 5, "from_s": float(t[20]), "until_s": None},
    ]


def test_where_the_end_is_too_tight_robots_wait_rather_than_touch_and_the_run_says_so() -> None:
    """Agents 1 and 2 start 0.19 m apart and keep to it: places of the end are 0.707 of that apart, less than Ds."""
    experiment = open_experiment("shape", ("plant.name=saturated", "agents.2.start=[-0.19, 0.5]"))
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    ends = separation(predicted_ends(experiment, trajectory.points[0])).distance
    settings = experiment.filter_settings
    assert ends.min() < settings.safe_distance
    assert metrics.outcome == "not_converged"
    assert deadlocks(trajectory, settings.stuck_time)
    assert metrics.separation.distance.min() > 2.0 * GTERNAL.chassis.radius


def test_the_trajectory_keeps_what_the_filter_said(tmp_path) -> None:
    trajectory = run()
    trajectory.save(tmp_path / "trajectory.npz", np.zeros((len(trajectory.t), 1)))
    with np.load(tmp_path / "trajectory.npz") as again:
        np.testing.assert_array_equal(again["intervention"], trajectory.intervention)
        np.testing.assert_array_equal(again["blockers"], trajectory.blockers)


def test_the_literal_replay_still_brings_the_robots_together() -> None:
    trajectory = run("safety.filter=none", "plant.name=saturated", duration=20.0)
    centres = collision_centres(trajectory.poses).view(np.complex128)[..., 0]
    a, b = np.triu_indices(6, 1)
    assert np.abs(centres[:, a] - centres[:, b]).min() < 0.05


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("safety.filter=magic", "safety.filter: expected 'none', 'decentralised'"),
        ("safety.gain_per_s=-1.0", "safety.gain_per_s: expected greater than or equal to"),
        ("safety.gian_per_s=1.0", "did you mean 'gain_per_s'?"),
        ("safety.safe_distance_m=0.5", "safety: sensing_range must be beyond safe_distance"),
        ("safety.turn_rad=nan", "safety.turn_rad: expected"),
        ("obstacles=[{vertices_m=[]}]", "obstacles[1].vertices_m: expected"),
        ("obstacles=[{vertices_m=[[0.9, 0.9]]}]", "obstacles[1]: radius of a disc must be positive"),
        ("obstacles=[{radius_m=0.1}]", "obstacles[1].vertices_m: missing"),
        ("obstacles=[{vertices_m=[[0, 0], [1, 0], [2, 0]]}]", "obstacles[1]: a polygon must be strictly convex"),
        ("obstacles=[{vertices_m=[[0.0, 0.5]], radius_m=0.1}]", "agents[id 1].start: expected at least 0.074 m from"),
        ("sensor.delay_periods=-1", "sensor.delay_periods: expected greater than or equal to 0"),
        ("sensor.delay_periods=0.5", "sensor.delay_periods: expected a valid integer"),
    ],
)
def test_bad_input_is_refused_in_one_line_with_exit_code_2(
    change: str, said: str, cli: Callable[..., tuple[int, str, str]]
) -> None:
    code, _, message = cli("show", "shape", "--set", change)
    assert code == 2
    assert said in message
    assert message.count("\n") == 1


def test_a_filter_for_points_is_refused(cli: Callable[..., tuple[int, str, str]]) -> None:
    code, _, message = cli("run", "shape", "--plant", "single_integrator", "--safety", "centralised")
    assert code == 2
    assert "--safety centralised: the plant single_integrator" in message


def test_a_delay_of_the_continuous_plant_is_refused() -> None:
    with pytest.raises(InputError, match=r"sensor\.delay_periods"):
        open_experiment("shape", ("plant.name=single_integrator", "sensor.delay_periods=1"))
