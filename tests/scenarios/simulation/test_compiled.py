"""The compiled period against the loop that Python steps, and what it is asked to leave to that loop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robots.compiled import compiled
from robots.worlds import lanes
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.online.watch import Achieved, Watch
from scenarios.simulation.compiled.ability import together, unable
from scenarios.simulation.compiled.runs import Runs
from scenarios.simulation.loop import simulate, step_by_step

PLANTS = ("single_integrator", "unicycle", "saturated", "pymunk")
ROUNDING = 1e-10  # metres, radians, m/s: a few thousand roundings of one period, carried through some 120 periods


def experiment(name: str, plant: str, safety: str, *changes: str, duration: float = 4.0) -> Experiment:
    return open_experiment(name, (f"plant.name='{plant}'", f"safety.filter='{safety}'", *changes), duration)


def states(of: Experiment, seeds: tuple[int, ...], most: int = 7) -> np.ndarray:
    """(T, F, n, L) all states of runs, start first."""
    runs = Runs(of, seeds)
    found = [runs.state[None, : lanes.RECORDED].copy()]
    found += [chunk.rows.copy() for chunk in runs.advance(most, recorded=True)]
    return np.concatenate(found)


def random_changes(rng: np.random.Generator) -> tuple[str, ...]:
    """A random scenario that the compiled period can do, out of one of the library's."""
    changes = [
        "random_start.x_m=[-0.9, 0.9]",
        f"robot.saturation='{rng.choice(['scale', 'clip'])}'",
        f"robot.projection_distance_m={rng.uniform(0.02, 0.06):.3f}",
        f"plant.control_period_s={rng.uniform(0.02, 0.05):.3f}",
        f"safety.turn_rad={rng.uniform(0.0, 1.0):.2f}",
        f"safety.stuck_time_s={rng.uniform(0.2, 2.0):.2f}",
        f"arena.walls={rng.choice(['true', 'false'])}",
    ]
    if rng.random() < 0.4:
        changes += ["sensor.position_noise_m=0.005", "sensor.bearing_noise_deg=2"]
    if rng.random() < 0.4:
        changes.append("obstacles=[{vertices_m=[[0.2, 0.1]], radius_m=0.05}, {vertices_m=[[-0.4, -0.3], [-0.2, 0.4]]}]")
    return tuple(changes)


@pytest.mark.parametrize("case", range(12))
def test_compiled_and_stepped_runs_agree_within_rounding(case: int) -> None:
    rng = np.random.default_rng(case)
    name = str(rng.choice(["shape", "maneuver", "scale-only", "orientation-only"]))
    safety, plant = str(rng.choice(["none", "decentralised"])), PLANTS[case % 4]
    own = ("law.first_follower=spiral",) if name == "maneuver" and case % 2 else ()
    one = experiment(name, plant, safety, *random_changes(rng), *own)
    assert unable(one) is None
    seeds = (case, case + 1) if together(one) else (case,)
    stepped, advanced = step_by_step(one, case), states(one, seeds)[..., 0]
    for field, expected in (
        (lanes.X, stepped.poses[..., 0]),
        (lanes.THETA, stepped.poses[..., 2]),
        (lanes.PY, stepped.points[..., 1]),
        (lanes.LEFT, stepped.wheel_speeds[..., 0]),
        (lanes.INTERVENTION, stepped.intervention),
        (lanes.RELAXATION, stepped.relaxation),
        (lanes.STUCK, stepped.stuck),
        (lanes.CONTACT, stepped.contact),
        (lanes.WX, stepped.wish[..., 0]),
        (lanes.UY, stepped.command[..., 1]),
    ):
        scale = 1.0 + np.nanmax(np.abs(expected), initial=0.0)
        np.testing.assert_allclose(advanced[:, field], expected, rtol=0.0, atol=ROUNDING * scale)


@pytest.mark.parametrize("safety", ["none", "decentralised"])
def test_a_run_has_the_same_bits_alone_and_among_others_in_chunks_of_any_length(safety: str) -> None:
    one = experiment("shape", "saturated", safety, "random_start.x_m=[-0.9, 0.9]")
    together, alone = states(one, tuple(range(9)), 7), states(one, (4,), 100)
    assert np.array_equal(together[..., 4:5], alone)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("safety", ["none", "decentralised"])
def test_what_is_watched_is_what_is_measured(plant: str, safety: str) -> None:
    one = experiment("shape", plant, safety, "random_start.x_m=[-1.4, 1.4]", "goal.accepted=true", duration=30.0)
    found: list[Achieved | None] = []
    for seeds in [(1, 2)] if together(one) else [(1,), (2,)]:
        runs = Runs(one, seeds)
        watch = Watch(one, runs.state)
        for chunk in runs.advance(16):
            watch.take(chunk)
        found += watch.achieved()
    for seed, achieved in zip((1, 2), found, strict=True):
        metrics = measure(one, simulate(one, seed))
        assert achieved is not None
        assert achieved.outcome == metrics.outcome
        assert achieved.accepted == metrics.verdict.accepted
        assert achieved.violations == tuple(violation.kind for violation in metrics.verdict.violations)
        assert achieved.settling_time == metrics.settling_time
        assert achieved.error_sum == metrics.error_sum[-1]
        assert achieved.axle_error_sum == metrics.axle_error_sum[-1]
        assert achieved.separation == metrics.separation.distance.min()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ("sensor.dropout=0.1", "sensor.dropout"),
        ("sensor.delay_periods=2", "sensor.delay_periods"),
        ("law.activation='sequential'", "law.activation"),
        ("safety.filter='centralised'", "safety.filter = 'centralised'"),
        ("robot.model='measured'", "robot.model"),
    ],
)
def test_what_the_compiled_period_cannot_do_is_left_to_python_by_name(change: str, reason: str) -> None:
    assert unable(open_experiment("shape", ("plant.name='saturated'", change))) == reason


def test_other_laws_are_left_to_python() -> None:
    assert unable(open_experiment("law-distance", ("plant.name='saturated'",))) == "law.name = 'distance'"


def test_sine_and_cosine_are_within_two_units_in_the_last_place() -> None:
    @compiled
    def both(angles: np.ndarray, out: np.ndarray) -> None:
        for k in range(len(angles)):
            out[0, k], out[1, k] = lanes.sine_cosine(angles[k])

    angles = np.concatenate([np.linspace(-7.0, 7.0, 20001), np.random.default_rng(0).uniform(-1e4, 1e4, 20000)])
    out = np.empty((2, len(angles)))
    both(angles, out)
    assert np.abs(out - [np.sin(angles), np.cos(angles)]).max() <= 2.0 * math.ulp(1.0)
