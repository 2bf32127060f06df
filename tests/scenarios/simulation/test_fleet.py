"""Robots of one run that differ: each has its own body, wheels and projected point, and nobody else's."""

import numpy as np
import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import load
from scenarios.errors import InputError
from scenarios.export.portable import start_poses
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate

OWN = ("agents.3.robot={projection_distance_m=0.06, wheel_speed_limit_rad_s=4.0}",)
LENGTH = 12.0


@pytest.mark.parametrize("plant", ["unicycle", "saturated", "pymunk"])
@pytest.mark.parametrize("safety", ["none", "decentralised"])
def test_each_robot_keeps_to_its_own_wheels_and_is_led_by_its_own_point(plant: str, safety: str) -> None:
    changes = (f"plant.name={plant}", f"safety.filter={safety}", *OWN)
    found = simulate(open_experiment("shape", changes, LENGTH), 0)
    ahead = np.linalg.norm(found.points - found.poses[..., :2], axis=-1)
    np.testing.assert_allclose(ahead, np.tile([0.025, 0.025, 0.06, 0.025, 0.025, 0.025], (len(ahead), 1)), atol=1e-12)
    fastest = np.abs(found.wheel_speeds).max(axis=(0, 2))
    if (plant, safety) != ("unicycle", "none"):  # which has no limit
        assert fastest[2] == pytest.approx(4.0, rel=1e-6)
        assert fastest.max() == pytest.approx(12.5, rel=1e-6)


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_a_robot_of_its_own_that_is_like_the_others_moves_like_them(plant: str) -> None:
    same = "agents.3.robot={projection_distance_m=0.025, wheel_speed_limit_rad_s=12.5, length_m=0.1, width_m=0.11}"
    plain, own = (
        simulate(open_experiment("shape", (f"plant.name={plant}", *changes), LENGTH), 0) for changes in ((), (same,))
    )
    np.testing.assert_allclose(own.poses, plain.poses, atol=1e-9)


def test_a_batch_of_runs_is_its_runs() -> None:
    experiment = open_experiment("shape", ("plant.name=saturated", "safety.filter=none", *OWN), LENGTH)
    together = simulate(experiment, [0, 1])
    for seed in (0, 1):
        np.testing.assert_allclose(together.points[:, seed], simulate(experiment, seed).points, atol=1e-12)


def test_the_verdict_warns_of_the_robot_whose_own_limit_is_broken() -> None:
    slow = ("plant.name=unicycle", "safety.filter=none", "agents.5.robot={wheel_speed_limit_rad_s=0.5}")
    experiment = open_experiment("fastest", slow, LENGTH)
    violations = {v.kind: v for v in measure(experiment, simulate(experiment, 0)).verdict.violations}
    limit = np.where(np.arange(experiment.n) == 4, 0.5, 12.5)
    speeds = np.abs(simulate(experiment, 0).wheel_speeds).max(axis=2)
    assert violations["actuator"].steps == int((speeds > limit).any(axis=1).sum())


@pytest.mark.parametrize(("width", "touched"), [(0.11, False), (0.23, True)])
def test_a_wider_body_touches_what_a_narrow_one_passes(width: float, touched: bool) -> None:
    """Robot 2 heads north beside robot 1, which stands 0.15 m to the west of its line."""
    starts = ["[0.0, 0.0]", "[0.15, -0.4]", "[-1.0, 0.8]", "[-1.0, -0.8]", "[1.0, 0.8]", "[1.0, -0.8]"]
    changes = [f"agents.{k}.start={start}" for k, start in enumerate(starts, start=1)]
    changes += [f"agents.{k}.heading_deg=90.0" for k in range(1, 7)]
    changes += [f"agents.2.robot={{width_m={width}}}", "law.name=displacement", "safety.filter=none"]
    stops = ", ".join(f"{{t_s=0.0, kind='stop', agent={k}}}" for k in (1, 3, 4, 5, 6))
    changes += [f"events=[{stops}]", "agents.2.target=[0.15, 0.9]", "target.angles_deg={}"]
    experiment = open_experiment("law-displacement", tuple(changes), 8.0)
    found = simulate(experiment, 0)
    assert (found.contact[:, 1] == 0).any() == touched
    assert experiment.fleet.outlines[1, :, 1].max() == pytest.approx(width / 2.0)


def test_robots_of_their_own_are_refused_where_all_must_be_equal() -> None:
    own = "agents.4.robot={width_m=0.2}"
    with pytest.raises(InputError, match=r"agents\[id 4\].robot: the centralised filter takes all robots for equal"):
        open_experiment("shape", (own, "safety.filter=centralised"))
    with pytest.raises(InputError, match=r"agents\[id 4\].robot: measured robots have numbers of their own"):
        open_experiment("shape", (own, "robot.model=measured"))
    with pytest.raises(InputError, match=r"agents\[id 4\].robot: the testbed's robots are all equal"):
        start_poses(open_experiment("maneuver-testbed", (own,)), 0)
    with pytest.raises(InputError, match=r"agents\[id 4\].robot.widht_m: unknown key, did you mean 'width_m'\?"):
        open_experiment("shape", ("agents.4.robot={widht_m=0.2}",))


def test_a_scenario_without_robots_of_their_own_has_the_digest_that_it_had() -> None:
    assert load("shape", ("events=[]",)).sha256 == load("shape").sha256
    assert load("shape", ("agents.4.robot={width_m=0.2}",)).sha256 != load("shape").sha256
