"""Runs of the compiled period alone, among others and watched, and what it is asked to leave to Python.

That they are the runs that Python steps, ``tests/fuzz/paths.py`` tries on random scenarios.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from robots.compiled import compiled
from robots.worlds import lanes
from robots.worlds.lanes import sine_cosine
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.online.watch import Achieved, Watch
from scenarios.simulation.compiled.ability import side_by_side, unable
from scenarios.simulation.compiled.runs import Runs
from scenarios.simulation.loop import simulate, step_by_step
from scenarios.studies.check.perturbed import perturbed

PLANTS = ("single_integrator", "unicycle", "saturated", "pymunk")


def experiment(name: str, plant: str, safety: str, *changes: str, duration: float = 4.0) -> Experiment:
    return open_experiment(name, (f"plant.name='{plant}'", f"safety.filter='{safety}'", *changes), duration)


def states(of: Experiment, seeds: tuple[int, ...], most: int = 7) -> np.ndarray:
    """(T, F, n, L) all states of runs, start first."""
    runs = Runs(of, seeds)
    found = [runs.state[None, : lanes.RECORDED].copy()]
    found += [chunk.rows.copy() for chunk in runs.advance(most, recorded=True)]
    return np.concatenate(found)


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
    for seeds in [(1, 2)] if side_by_side(one) else [(1,), (2,)]:
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
        ("sensor.gyro_noise_deg_s=1", "sensor.gyro_noise_deg_s"),
        ("communication.message_loss=0.1", "communication.message_loss"),
        ("events=[{t_s=1, kind='stop', agent=3}]", "events.t_s"),
        ("safety.filter='centralised'", "safety.filter = 'centralised'"),
        ("robot.model='measured'", "robot.model"),
    ],
)
def test_what_the_compiled_period_cannot_do_is_left_to_python_by_name(change: str, reason: str) -> None:
    assert unable(open_experiment("shape", ("plant.name='saturated'", change))) == reason


@pytest.mark.parametrize("plant", ["single_integrator", "saturated"])
@pytest.mark.parametrize("name", ["circle", "figure-eight", "consensus-velocity", "sequential"])
def test_what_agents_are_told_and_who_waits_is_compiled_and_as_python_steps_it(name: str, plant: str) -> None:
    changes = ("law.settled_m=0.1",) if name == "sequential" else ()
    one = experiment(name, plant, "none", *changes, duration=12.0)
    assert unable(one) is None
    found, stepped = simulate(one, 3), step_by_step(one, 3)
    assert np.abs(found.points - stepped.points).max() < 1e-11
    assert np.array_equal(found.active, stepped.active)
    assert (name != "sequential") == bool(found.active[0].all())
    assert found.active[-1].all()


def test_other_laws_are_left_to_python() -> None:
    assert unable(open_experiment("law-distance", ("plant.name='saturated'",))) == "law.name = 'distance'"


def test_sine_and_cosine_are_within_two_units_in_the_last_place() -> None:
    @compiled
    def both(angles: np.ndarray, out: np.ndarray) -> None:
        for k in range(len(angles)):
            out[0, k], out[1, k] = sine_cosine(angles[k])

    near = np.linspace(-lanes.WITHIN, lanes.WITHIN, 20001)
    out = np.empty((2, len(near)))
    both(near, out)
    assert np.array_equal(out, np.transpose([lanes.sine_cosine_within(angle) for angle in near.tolist()]))
    angles = np.concatenate([np.linspace(-7.0, 7.0, 20001), np.random.default_rng(0).uniform(-1e4, 1e4, 20000)])
    out = np.empty((2, len(angles)))
    both(angles, out)
    assert np.abs(out - [np.sin(angles), np.cos(angles)]).max() <= 2.0 * math.ulp(1.0)


def test_two_ways_of_stepping_part_only_where_held_commands_are_chaotic() -> None:
    """Above 2 l / T a heading does not settle along a command that is held (NID): rounding grows in any arithmetic."""
    apart = {}
    for period in (0.033, 0.005):
        changes = ("plant.name='unicycle'", "safety.filter='none'", f"plant.control_period_s={period}")
        one = open_experiment("random-50", changes, 2.0)
        stepped, limit = step_by_step(one, 0), one.nid.turning_limit(period)
        fastest = np.linalg.norm(stepped.command, axis=-1).max()
        runs = (simulate(one, 0), step_by_step(perturbed(one, 1), 0))
        apart[bool(fastest > limit)] = [float(np.abs(run.points - stepped.points).max()) for run in runs]
    assert min(apart[True]) > 0.1
    assert apart[False][0] < 1e-13
    assert apart[False][1] < 1e-10
