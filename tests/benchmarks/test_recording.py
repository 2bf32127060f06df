"""What a recording costs: encoding and writing it, and by how much it makes the whole command longer."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from scenarios.definition.experiment import Experiment, build, open_experiment
from scenarios.definition.load import ScenarioFile, load
from scenarios.measures.metrics import Metrics, measure
from scenarios.measures.result import result
from scenarios.recording.encode import encode
from scenarios.recording.file import write
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

Recorded = Callable[..., Trajectory]

STEPS, ROBOTS = 3600, 200

PAIRS = 9
"""Of runs with and without a recording."""


def record(experiment: Experiment, trajectory: Trajectory, metrics: Metrics, folder: Path) -> None:
    summary = result(experiment, 0, trajectory, metrics)
    write(folder / "recording.rrd", encode(experiment, trajectory, metrics, summary))


def crowd(recorded: Recorded) -> tuple[Experiment, Trajectory]:
    """Two hundred robots on a random graph that circle about their targets: states without a simulation."""
    random = {"agents": ROBOTS, "seed": 1, "radius_m": 12.0, "min_separation_m": 0.3, "min_angle_deg": 5.0}
    scenario = load("random-50").scenario
    changed = scenario.model_copy(update={"random_formation": scenario.random_formation.model_copy(update=random)})
    experiment = build(ScenarioFile("crowd", "crowd", "", changed))
    t = np.linspace(0.0, 120.0, STEPS)
    turn = t[:, None] + np.arange(ROBOTS)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    points = experiment.target.positions + circle
    poses = np.concatenate([points, turn[..., None]], axis=-1)
    return experiment, recorded(t, poses, points, wheel_speeds=circle)


def test_a_recording_adds_at_most_300_ms_to_a_maneuver(benchmark: Any, target: Any, tmp_path: Path) -> None:
    experiment = open_experiment("maneuver")
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    benchmark(record, experiment, trajectory, metrics, tmp_path)
    target("recording a 120 s maneuver of 6 robots", benchmark.stats.stats.median, 0.3, "s")


def test_two_hundred_robots_are_recorded_within_3_s(
    benchmark: Any, target: Any, recorded: Recorded, tmp_path: Path
) -> None:
    experiment, trajectory = crowd(recorded)
    metrics = measure(experiment, trajectory)
    benchmark.pedantic(record, (experiment, trajectory, metrics, tmp_path), rounds=3)
    target(f"recording {ROBOTS} robots x {STEPS} steps", benchmark.stats.stats.median, 3.0, "s")


def test_a_recording_lengthens_a_run_by_at_most_300_ms_or_a_tenth(benchmark: Any, target: Any, tmp_path: Path) -> None:
    """The command from start to end, with and without a recording by turns, so that both meet the same noise."""
    formation = [sys.executable, "-m", "scenarios", "run", "maneuver", "--out", str(tmp_path / "run")]

    def seconds(*options: str) -> float:
        start = perf_counter()
        subprocess.run([*formation, *options], check=True, stdout=subprocess.DEVNULL)
        return perf_counter() - start

    seconds()  # compiles the filter where that has not been done
    pairs = np.array([(seconds(), seconds("--no-recording")) for _ in range(PAIRS)])
    benchmark(lambda: None)
    with_it, without = np.median(pairs, axis=0)
    added = np.median(pairs[:, 0] - pairs[:, 1])
    target(f"a recording's share of `run maneuver`, {with_it:.2f} s", added, max(0.3, 0.1 * without), "s")
