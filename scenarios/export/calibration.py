"""A script for the testbed that tells what no public log does: it drives straight, spins, chirps, and logs."""

from __future__ import annotations

from robots.model import CONTROL_PERIOD, GTERNAL

SCRIPT = '''"""Calibrate one robot of the Robotarium: drive straight, spin, chirp, stand, and log every turn.

Needs numpy and the Robotarium's own package, rps. It leaves calibration.npz:
    t (T,) seconds by the clock, poses (T, 3), counts (T, 2) where the robots have encoders, commands (T, 2) v, omega.
`formation identify calibration.npz` reads it. What each part tells:
    spins in both directions      base length, apart from a drift
    straights, both directions    wheel radius, drift of the heading per metre, unequal wheels
    steps                         delay from command to motion, motor lag, time-out of lost commands
    chirps                        the wheel-speed loop's bandwidth
    rest                          noise of the cameras
"""

import time

import numpy as np
import rps.robotarium as robotarium

STEP = {step!r}  # s, of the simulator; the testbed takes longer
SPEED = {speed!r}  # m/s, three quarters of the wheels' limit
SPIN = {spin!r}  # rad/s, likewise
WAY = 0.8  # m, from one end to the other
SPINS = 20  # whole turns each way


def held(v, omega, seconds):
    return np.tile([v, omega], (max(1, round(seconds / STEP)), 1))


def chirp(amplitude, axis, seconds, low=0.1, high=3.0):
    """A sine whose frequency grows from low to high, Hz."""
    t = STEP * np.arange(round(seconds / STEP))
    commands = np.zeros((len(t), 2))
    commands[:, axis] = amplitude * np.cos(2.0 * np.pi * (low * t + 0.5 * (high - low) * t**2 / seconds))
    return commands


spin_time = 2.0 * np.pi * SPINS / SPIN
there, half = WAY / SPEED, 0.5 * WAY / SPEED
commands = np.concatenate(
    [held(0.0, 0.0, 3.0)]
    + [held(-SPEED, 0.0, half), held(0.0, 0.0, 1.0)]
    + [held(v, 0.0, there) for v in (SPEED, -SPEED) * 5]
    + [held(0.0, 0.0, 2.0), held(0.0, SPIN, spin_time), held(0.0, 0.0, 2.0), held(0.0, -SPIN, spin_time)]
    + [held(0.0, 0.0, 2.0)]
    + [part for sign in (1.0, -1.0) * 5 for part in (held(sign * SPEED, 0.0, 1.0), held(0.0, 0.0, 1.0))]
    + [chirp(SPIN / 2.0, 1, 20.0), held(0.0, 0.0, 1.0), chirp(SPEED / 2.0, 0, 20.0), held(0.0, 0.0, 3.0)]
)

robot = robotarium.Robotarium(
    number_of_robots=1, show_figure=False, sim_in_real_time=False, initial_conditions=np.zeros((3, 1))
)
read_encoders = getattr(robot, "get_encoders", None)
log = {{"t": [], "poses": [], "counts": [], "commands": []}}
for command in commands:
    log["poses"].append(robot.get_poses()[:, 0])
    if read_encoders is not None:
        log["counts"].append(np.asarray(read_encoders())[:, 0])
    log["t"].append(time.monotonic())
    log["commands"].append(command)
    robot.set_velocities(np.array([0]), command[:, None])
    robot.step()
np.savez("calibration.npz", **{{name: np.array(rows) for name, rows in log.items() if rows}})
robot.call_at_scripts_end()
'''


def calibration() -> str:
    """The script."""
    drive = GTERNAL.drive
    return SCRIPT.format(
        step=CONTROL_PERIOD,
        speed=round(0.75 * float(drive.speed_limit), 3),
        spin=round(0.75 * float(drive.turn_limit), 3),
    )
