"""Compare our Robotarium interface with the public simulator, ``rps`` 2.1, and run exported scripts on both.

    .venv/bin/python docs/against_rps.py --seeds 20

``rps`` has to be importable (github.com/robotarium/robotarium_python_simulator). Prints the figures of
docs/robotarium.md; those of its own examples are docs/scripts_on_rps.py's.
"""

import argparse
import contextlib
import io
import random
import sys
import types
import warnings

import numpy as np
import rps.robotarium

import robots.robotarium
from robots import GTERNAL
from scenarios.definition.experiment import open_experiment
from scenarios.export.script import script

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
    given = parser.parse_args()
    Peer.skip = True
    compare_steps()
    Peer.skip = False
    for scenario, changes in EXPORTED:
        run_exported(scenario, changes, given.seeds)


if __name__ == "__main__":
    main()
