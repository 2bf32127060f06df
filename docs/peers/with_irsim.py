"""ir-sim: differential drive with collisions, no display."""

import tempfile
from importlib.metadata import version
from pathlib import Path

import irsim
import numpy as np
from work import PERIOD, STARTS, commands, told

WORLD = f"""
world:
  {{height: 4, width: 4, offset: [-2, -2], step_time: {PERIOD}, sample_time: {PERIOD}, collision_mode: unobstructed}}
robot:
  - number: {len(STARTS)}
    distribution: {{name: manual}}
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.055}}
    vel_max: [0.2, 3.8]
    vel_min: [-0.2, -3.8]
    state: [{", ".join(f"[{x}, {y}, 0.0]" for x, y in STARTS)}]
    goal: [{", ".join("[9.0, 9.0, 0.0]" for _ in STARTS)}]
"""


def work(runs: int, steps: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "world.yaml"
        path.write_text(WORLD, encoding="utf-8")
        world = irsim.make(str(path), display=False, disable_all_plot=True, log_level="ERROR")
        for _ in range(steps):
            x, y, theta = np.hstack([robot.state[:3] for robot in world.robot_list])
            v, omega = commands(np, x, y, theta)
            world.step([np.array([[a], [b]]) for a, b in zip(v, omega, strict=True)])
        world.end(0)


told("ir-sim", version("ir-sim"), work, (1, 300))
