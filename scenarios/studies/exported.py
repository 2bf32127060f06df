"""What becomes of an exported script: run it as the testbed would, from its chargers on, and see whether it arrives.

Each seed is one run: of the generators that chargers and detours are drawn from. A run that the public simulator makes
with that seed goes the same way, but for what its numerics do (docs/robotarium.md).
"""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.markup import escape

from robots.measured import MEASURED
from robots.model import CONTROL_PERIOD
from robots.rps.session import Session
from robots.testbed import OBSTACLE_DISTANCE, collision_centres, judge
from scenarios.definition.experiment import Experiment
from scenarios.export.script import script
from scenarios.measures.window import trailing
from scenarios.simulation.script.execute import execute
from scenarios.simulation.script.script_file import read
from scenarios.terminal import new_table, print_table

Real = NDArray[np.float64]

PLANTS = ("saturated", "pymunk")
MEASURED_ROBOTS = "measured"
"""Beside the plants: robots as logs and firmware show them, on ``pymunk``."""


@dataclass(frozen=True)
class Arrival:
    """What one run of an exported script gave.

    Attributes:
        plant, seed: of the run; ``measured`` for robots as logs and firmware show them.
        started: whether the robots came from their chargers to their start.
        error_sum: of the angles at the end, radians, infinite where they did not start; of measured robots, which never
            come to rest, the sum of the mean errors over the last seconds, as in a run.
        reached: whether that is below the scenario's goal.
        accepted: the testbed's verdict on the script's own part.
        clear: whether robots kept off the scenario's obstacles, of which the testbed has none.
        kinds: of the violations.
        seconds: that the script's part took.
    """

    plant: str
    seed: int
    started: bool
    error_sum: float
    reached: bool
    accepted: bool
    kinds: tuple[str, ...]
    seconds: float
    clear: bool = True

    @property
    def arrives(self) -> bool:
        """Whether the testbed would run it to its goal, past the obstacles that the scenario imagines there."""
        return self.started and self.reached and self.accepted and self.clear


def check(
    experiment: Experiment,
    seed: int,
    seeds: Sequence[int],
    plants: Sequence[str] = (*PLANTS, MEASURED_ROBOTS),
    advance: Callable[[int, int], None] = lambda done, total: None,
) -> list[Arrival]:
    """Run the script that ``export`` writes for the scenario's ``seed``, on each plant with each of ``seeds``.

    Raises:
        InputError: the testbed cannot run the scenario; the message names the field.
    """
    text = script(experiment, seed).replace("SHOW_FIGURE = True", "SHOW_FIGURE = False")
    runs = [(plant, each) for plant in plants for each in seeds]
    found = []
    with tempfile.TemporaryDirectory(prefix="formation-export-") as folder:
        path = Path(folder) / f"{experiment.file.name.replace('-', '_')}.py"
        path.write_text(text, encoding="utf-8")
        for done, (plant, each) in enumerate(runs, start=1):
            found.append(arrival(experiment, path, plant, each))
            advance(done, len(runs))
    return found


def rehearse(experiment: Experiment, text: str, seed: int) -> Arrival:
    """One run of an exported script on ``saturated``, robots standing somewhere within the testbed's tolerance."""
    with tempfile.TemporaryDirectory(prefix="formation-export-") as folder:
        path = Path(folder) / "rehearsal.py"
        path.write_text(text.replace("SHOW_FIGURE = True", "SHOW_FIGURE = False"), encoding="utf-8")
        return _run(experiment, path, "saturated", seed, Session("saturated", "near", np.random.default_rng(seed)))


def arrival(experiment: Experiment, path: Path, plant: str, seed: int) -> Arrival:
    """One run of an exported script."""
    session = Session(plant, "driven")
    if plant == MEASURED_ROBOTS:
        model = experiment.measured or MEASURED
        session = Session("pymunk", "driven", np.random.default_rng(seed), measured=model)
    return _run(experiment, path, plant, seed, session)


def _run(experiment: Experiment, path: Path, plant: str, seed: int, session: Session) -> Arrival:
    with contextlib.redirect_stdout(io.StringIO()):
        ending = execute(read(path, 2), (), session, seed)
    if not ending.robots:
        return Arrival(plant, seed, False, float("inf"), False, False, (), 0.0)
    record = ending.robots[-1].record()
    errors = experiment.angles.errors(experiment.nid.project(record.poses), experiment.of_phase(-1).target_angles)
    last = trailing(record.t, errors).mean[-1] if plant == MEASURED_ROBOTS else errors[-1]
    error = float(np.abs(last).sum())
    verdict = judge(record.t, record.poses, record.wheel_speeds)
    kinds = tuple(violation.kind for violation in verdict.violations)
    seconds = CONTROL_PERIOD * (len(record.t) - 1)
    reached, clear = error < experiment.goal, _clear(experiment, record.poses)
    return Arrival(plant, seed, True, error, reached, verdict.accepted, kinds, seconds, clear)


def _clear(experiment: Experiment, poses: Real) -> bool:
    obstacles, centres = experiment.arena.obstacles, collision_centres(poses)
    return all((obstacle.distance(centres) > OBSTACLE_DISTANCE).all() for obstacle in obstacles)


def print_check(console: Console, experiment: Experiment, found: Sequence[Arrival]) -> None:
    """A row for each plant, and a line for each seed that does not arrive."""
    table = new_table("plant", "runs", "come to the start", "reach the goal", "accepted", "error sum, median (rad)")
    for plant in dict.fromkeys(each.plant for each in found):
        runs = [each for each in found if each.plant == plant]
        errors = [each.error_sum for each in runs if each.started]
        table.add_row(
            plant,
            str(len(runs)),
            str(sum(each.started for each in runs)),
            str(sum(each.reached for each in runs)),
            str(sum(each.accepted for each in runs)),
            f"{np.median(errors):.1e}" if errors else "-",
        )
    print_table(console, table)
    console.print()
    for each in found:
        if not each.arrives:
            console.print(escape(f"{each.plant}, seed {each.seed}: {why(each, experiment)}"))
    if all(each.arrives for each in found):
        console.print("The testbed would run it to its goal, from every one of these starts.")


def why(each: Arrival, experiment: Experiment) -> str:
    """Why a run does not arrive."""
    if not each.started:
        return "the robots do not come to their start; it is too crowded there"
    reasons = [] if each.reached else [f"the angle errors add up to {each.error_sum:.1e} rad, goal {experiment.goal:g}"]
    hard = [kind for kind in each.kinds if kind != "actuator"]
    touched = [] if each.clear else ["robots come too close to an obstacle"]
    return "; ".join([*reasons, *(["rejected: " + ", ".join(hard)] if hard else []), *touched])
