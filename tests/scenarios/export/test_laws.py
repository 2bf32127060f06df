"""Laws, references, events and obstacles in exported scripts: each is what the run has, or what its equation says."""

from collections.abc import Callable

import numpy as np
import pytest

from formation.plane import as_complex
from robots.robotarium import create_si_barrier_certificate_with_boundary
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.export.laws import LINEAR, WRITTEN
from scenarios.export.script import script

Same = Callable[[Experiment, int, str, float], None]
Functions = Callable[[str], dict]


@pytest.mark.parametrize("name", [name for name in (*LINEAR, *WRITTEN) if name != "distance"])
def test_laws_of_the_field_give_the_velocities_of_the_law_itself(name: str, functions: Functions) -> None:
    experiment = open_experiment(f"law-{name}")
    law = functions(script(experiment, 0))["law"]
    rng = np.random.default_rng(0)
    delta = None if experiment.phases[0].delta is None else np.array(experiment.phases[0].delta)
    for _ in range(20):
        p = rng.uniform(-1.0, 1.0, (experiment.n, 2))
        headings = np.tile([1.0, 0.0], (experiment.n, 1))
        measured = experiment.instruments.deliver(experiment.instruments.measure(p, headings, p), None)
        compass = headings if experiment.law.needs_compass else None
        np.testing.assert_allclose(
            law(as_complex(p)), as_complex(experiment.law(*measured, compass, delta)), atol=1e-12
        )


def test_wrapped_errors_and_gains_of_ones_own_are_in_the_script(functions: Functions) -> None:
    for name, key, value in (("bisector", "wrapped", 1.0), ("area", "gain", 3.0), ("ratio", "speed", 0.2)):
        experiment = open_experiment(f"law-{name}", (f"law.parameters.{key}={value}",))
        law, p = functions(script(experiment, 0))["law"], np.random.default_rng(1).uniform(-1.0, 1.0, (experiment.n, 2))
        headings = np.tile([1.0, 0.0], (experiment.n, 1))
        measured = experiment.instruments.deliver(experiment.instruments.measure(p, headings, p), None)
        np.testing.assert_allclose(
            law(as_complex(p)), as_complex(experiment.law(*measured, None, None)), atol=1e-12, err_msg=name
        )


@pytest.mark.parametrize(
    "reference",
    [
        {"kind": "circle", "width_m": 0.5, "period_s": 30.0, "displacement_m": [0.5, 0.0]},
        {
            "kind": "ellipse",
            "width_m": 0.5,
            "height_m": 0.3,
            "period_s": 30.0,
            "clockwise": True,
            "direction_deg": 40.0,
        },
        {"kind": "figure-eight", "width_m": 0.5, "height_m": 0.3, "period_s": 40.0, "orientation": "kept"},
        {"kind": "figure-eight", "width_m": 0.5, "height_m": 0.3, "period_s": 40.0, "clockwise": True},
        {
            "kind": "ramps",
            "velocities": [{"t_s": 0.0, "velocity_m_s": [0, 0]}, {"t_s": 91 * 0.033, "velocity_m_s": [0.03, -0.02]}],
        },
        {
            "kind": "ramps",
            "velocities": [
                {"t_s": 0.0, "velocity_m_s": [0.01, 0]},
                {"t_s": 91 * 0.033, "velocity_m_s": [0.02, -0.01], "scale": 0.9, "turn_deg": 15.0},
                {"t_s": 150 * 0.033, "velocity_m_s": [0.0, 0.0], "scale": 0.95, "turn_deg": 5.0},
            ],
        },
        {
            "kind": "way-points",
            "points": [
                {"t_s": 0.0, "position_m": [0.0, 0.0]},
                {"t_s": 3.0, "position_m": [0.1, 0.1], "scale": 0.7, "turn_deg": 40.0},
                {"t_s": 5.0, "position_m": [0.2, 0.0], "scale": 0.9},
            ],
        },
    ],
)
@pytest.mark.parametrize("feedforward", [True, False])
def test_references_are_told_in_the_script_as_in_the_run(
    varied: Callable[..., Experiment], moves_as_the_run: Same, reference: dict, feedforward: bool
) -> None:
    experiment = varied(
        duration_s=200 * 0.033,
        law={"first_follower": "displacement", "feedforward": feedforward},
        reference=reference,
        plant={"name": "saturated"},
        safety={"filter": "none"},
    )
    moves_as_the_run(experiment, 1, "saturated", 1e-7)


def test_robots_stop_in_the_script_as_in_the_run(varied: Callable[..., Experiment], moves_as_the_run: Same) -> None:
    experiment = varied(
        duration_s=6.6,
        events=[
            {"t_s": 50 * 0.033, "kind": "stop", "agent": 4, "until_s": 90 * 0.033},
            {"t_s": 150 * 0.033, "kind": "stop", "agent": 6},
        ],
        plant={"name": "saturated"},
        safety={"filter": "none"},
    )
    moves_as_the_run(experiment, 1, "saturated", 1e-7)


def test_shapes_change_in_the_script_as_in_the_run(moves_as_the_run: Same) -> None:
    changes = ('plant.name="saturated"', 'safety.filter="none"', "events.1.t_s=3.3", "events.2.t_s=6.6")
    experiment = open_experiment("reshape", changes, duration=9.9)
    assert len(experiment.phases) == 3
    moves_as_the_run(experiment, 0, "saturated", 1e-7)


def scene(seed: int, experiment: Experiment) -> tuple[np.ndarray, np.ndarray]:
    """(6,) wishes, m/s, and points that are apart from each other and from all obstacles, metres."""
    rng = np.random.default_rng(seed)
    while True:
        p = rng.uniform(-0.9, 0.9, (6, 2))
        apart = np.linalg.norm(p[:, None] - p, axis=-1) + np.eye(6)
        if apart.min() > 0.16 and min(each.distance(p).min() for each in experiment.arena.obstacles) > 0.01:
            return as_complex(rng.uniform(-0.2, 0.2, (6, 2))), as_complex(p)


@pytest.mark.parametrize("seed", range(15))
def test_the_certificate_with_obstacles_keeps_off_them_and_is_else_the_testbeds(
    seed: int, functions: Functions
) -> None:
    experiment = open_experiment("obstacles")
    names = functions(script(experiment, 0))
    u, p = scene(seed, experiment)
    safe = names["certificate"](u, p)
    assert safe.any()
    for obstacle in experiment.arena.obstacles:
        gaps, normals = obstacle.nearest(np.stack([p.real, p.imag], axis=1))
        leaves = (safe * (normals[:, 0] - 1j * normals[:, 1])).real
        assert (leaves >= -5.0 * (gaps - 0.08) - 1e-6).all()
    names["OBSTACLES"].clear()
    plain = create_si_barrier_certificate_with_boundary(boundary_points=np.array([-1.6, 1.6, -1.0, 1.0]))
    there = plain(np.array([u.real, u.imag]), np.array([p.real, p.imag]))
    np.testing.assert_allclose(names["certificate"](u, p), there[0] + 1j * there[1], atol=1e-7)


def test_what_a_script_cannot_bring_about_is_refused_by_name(varied: Callable[..., Experiment]) -> None:
    for experiment, field in (
        (open_experiment("lost-edges"), "sensor.edge_loss"),
        (open_experiment("lost-edges", ("sensor.edge_loss=0.0",)), r"events\[1\].kind"),
        (open_experiment("own-law"), "law.name"),
        (open_experiment("random-50"), "arena.x_m"),
        (open_experiment("reshape", ('law.activation="sequential"',)), "law.activation"),
        (varied('law.without_neighbour="another-pair"'), "law.without_neighbour"),
    ):
        with pytest.raises(InputError, match=f": {field}: .*"):
            script(experiment)
