"""The public Robotarium simulator: `python with_rps.py BARRIER`, ``none`` or ``certificate``."""

import sys

import numpy as np
import rps
import rps.robotarium
from rps.utilities.barrier_certificates import create_si_barrier_certificate
from work import AHEAD, STARTS, commands, told, velocities

BARRIER = sys.argv[1]


def work(runs: int, steps: int) -> None:
    poses = np.array([[x, y, 0.0] for x, y in STARTS]).T
    robots = rps.robotarium.Robotarium(
        number_of_robots=len(STARTS), show_figure=False, sim_in_real_time=False, initial_conditions=poses,
        skip_initialization=True,
    )  # fmt: skip
    barrier = create_si_barrier_certificate()
    for _ in range(steps):
        x, y, theta = robots.get_poses()
        if BARRIER == "none":
            unicycle = np.array(commands(np, x, y, theta))
        else:
            c, s = np.cos(theta), np.sin(theta)
            points = np.array([x + AHEAD * c, y + AHEAD * s])
            ux, uy = barrier(np.array(velocities(np, *points)), points)
            unicycle = np.array([ux * c + uy * s, (uy * c - ux * s) / AHEAD])
        robots.set_velocities(np.arange(len(STARTS)), unicycle)
        robots.step()


told("rps", getattr(rps, "__version__", "of its repository"), work, (1, 300))
