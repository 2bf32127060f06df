"""Compare our Robotarium interface with the public simulator, ``rps`` 2.1, and run exported scripts on both.

    .venv/bin/python docs/against_rps.py --seeds 20
    .venv/bin/python docs/against_rps.py --examples FOLDER

``rps`` has to be importable (github.com/robotarium/robotarium_python_simulator); FOLDER is the ``rps/examples`` of its
source. Prints the figures of docs/robotarium.md.
"""

import argparse
import contextlib
import io
import random
import sys
import types
import warnings
from pathlib import Path

import numpy as np
import rps.robotarium
from rps.utilities.misc import generate_random_poses

import robots.robotarium
from robots import GTERNAL
from scenarios.definition.experiment import open_experiment
from scenarios.export.script import script

EXAMPLES = (
    "go_to_goal/go_to_point_si.py",
    "go_to_goal/go_to_pose_clf.py",
    "formation_control/formation_control.py",
    "leader_follower/leader_follower.py",
)
EXPORTED: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("shape", ()),
    ("shape", ("agents.4.start=[0.4, 0.6]",)),
    ("shape", ('safety.filter="none"',)),
    ("maneuver-testbed", ()),
    ("maneuver-testbed", ('safety.filter="none"',)),
)
LONGEST = 6000  # steps, after which a script, or the public simulator's drive to the start, counts as stuck


class StuckError(Exception):
    """The script has not come to its end, or the public simulator has not brought the robots to their start."""


class Peer(rps.robotarium.Robotarium):
    """The public simulator without figure and waiting, and with an end to its initialisation."""

    skip = False
    made: list["Peer"] = []  # noqa: RUF012

    def __init__(self, **arguments: object) -> None:
        self.made.append(self)
        quiet = {"show_figure": False, "sim_in_real_time": False, "skip_initialization": self.skip}
        super().__init__(**(arguments | quiet))

    def step(self) -> None:
        if self.initializing and self._iteration == LONGEST:
            raise StuckError
        super().step()


class Ours(robots.robotarium.Robotarium):
    """Our simulator, with random poses drawn as the public one draws them."""

    world = "pymunk"
    made: list["Ours"] = []  # noqa: RUF012

    def __init__(self, number_of_robots: int = -1, initial_conditions: np.ndarray | None = None, **_: object) -> None:
        self.made.append(self)
        self.steps = 0
        if initial_conditions is None:
            initial_conditions = generate_random_poses(number_of_robots, spacing=0.5, width=2.75, height=1.75)
        super().__init__(number_of_robots, initial_conditions=initial_conditions, plant=self.world)

    def step(self) -> None:
        self.steps += 1
        if self.steps > LONGEST:
            raise StuckError
        super().step()


def execute(text: str, simulator: type, seed: int) -> tuple[dict, object]:
    """Run a script on a simulator; its names, and the simulator at the end."""
    stand_in = types.ModuleType("rps.robotarium")
    stand_in.Robotarium = simulator
    original, rps.robotarium, sys.modules["rps.robotarium"] = rps.robotarium, stand_in, stand_in
    np.random.seed(seed)  # noqa: NPY002 rps draws from the global generators
    random.seed(seed)
    names = {"__name__": "__main__"}
    try:
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(text, "script", "exec"), names)
    finally:
        rps.robotarium = sys.modules["rps.robotarium"] = original
    return names, simulator.made[-1]


def compare_steps() -> None:
    """One step, and a minute of steps, of 22 robots with the same random wheel speeds, changed every second."""
    n, rng = 22, np.random.default_rng(0)
    for reach, wheels in ((1.0, "within the wheels' limit"), (3.0, "up to three times beyond it")):
        for plant in ("saturated", "pymunk"):
            for steps in (1, 1818):
                start = np.concatenate([rng.uniform(-100.0, 100.0, (2, n)), rng.uniform(-3.1, 3.1, (1, n))])
                peer = Peer(number_of_robots=n, initial_conditions=start)
                ours = robots.robotarium.Robotarium(n, initial_conditions=start, plant=plant)
                for step in range(steps):
                    if step % 30 == 0:
                        command = GTERNAL.drive.twist(rng.uniform(-12.5 * reach, 12.5 * reach, (n, 2))).T
                    for simulator in (peer, ours):
                        simulator.get_poses()
                        simulator.set_velocities(np.arange(n), command)
                        simulator.step()
                apart, turned = difference(peer.get_poses(), ours.get_poses())
                print(f"{plant}, {wheels}, {steps} steps: {apart:.1e} m, {turned:.1e} rad")


def difference(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
    """The largest distance, m, and turn, rad, between poses (3, N)."""
    return np.hypot(*(a - b)[:2]).max(), np.abs(np.angle(np.exp(1j * (a[2] - b[2])))).max()


def compare_examples(folder: Path) -> None:
    """Where the public simulator's own examples end on both."""
    for example in EXAMPLES:
        text = (folder / example).read_text(encoding="utf-8")
        _, peer = execute(text, Peer, 0)
        for Ours.world in ("saturated", "pymunk"):
            with contextlib.suppress(StuckError):
                execute(text, Ours, 0)
            ours = Ours.made[-1]
            t, poses, _ = ours.recorded()
            apart, turned = difference(peer._poses, poses[-1].T)
            steps = f"{peer._iteration} and {len(t) - 1} steps{', stuck' if len(t) > LONGEST else ''}"
            print(f"{example}, {Ours.world}: {apart:.1e} m, {turned:.1e} rad, {steps}")


def run_exported(scenario: str, changes: tuple[str, ...], seeds: int) -> None:
    """Exported scripts of heading seeds 0 .. seeds - 1 on the public simulator."""
    errors, accepted, stuck = [], 0, 0
    experiment = open_experiment(scenario, changes)
    for seed in range(seeds):
        try:
            names, peer = execute(script(experiment, seed), Peer, seed)
        except StuckError:
            stuck += 1
            continue
        x, y, theta = peer._poses
        points = x + 1j * y + names["AHEAD"] * np.exp(1j * theta)
        errors.append(abs(names["angle_errors"](points)).sum())
        accepted += not peer._errors.keys() - {"exceeded_actuator_limits"}
    reached = sum(error < experiment.goal for error in errors)
    print(
        f"{scenario} {' '.join(changes)}: {reached} of {seeds} reach the goal, {accepted} accepted, {stuck} stuck on "
        f"the way to the start; angle error sum median {np.median(errors):.1e}, most {max(errors):.1e} rad"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--examples", type=Path)
    given = parser.parse_args()
    Peer.skip = True
    if given.examples is not None:
        compare_examples(given.examples)
    else:
        compare_steps()
        Peer.skip = False
        for scenario, changes in EXPORTED:
            run_exported(scenario, changes, given.seeds)


if __name__ == "__main__":
    main()
