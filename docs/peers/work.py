"""The work that all peers do, and how its time is taken: six robots form the shape of the scenario `shape`.

Knows no peer, and nothing of this project: arrays of whatever package has numpy's names.
"""

import json
import sys
import time

STARTS = [(0.0, 0.5), (-0.5, 0.0), (0.0, 0.025), (0.25, 0.4), (0.5, -0.35), (0.6, 0.2)]
TARGET = [0, 1, 1j, 1 + 1j, 1.5 - 0.5j, -0.5 + 1.5j]
FOLLOWERS = [(0, 1, 2), (1, 2, 3), (0, 3, 4), (0, 3, 5)]  # rows (i, j, k): k senses i and j
AHEAD = 0.025  # metres from the axle to the point that the law steers
PERIOD = 0.033  # seconds
REPEATS = 5


def constants() -> list[tuple[float, float, float]]:
    """(r_k, Re w_k, Im w_k) of each follower: its law is u_k = r_k ((1 - w_k) p_i + w_k p_j - p_k)."""
    found = []
    for i, j, k in FOLLOWERS:
        w = (TARGET[k] - TARGET[i]) / (TARGET[j] - TARGET[i])
        turn = (TARGET[j] - TARGET[k]) * (TARGET[i] - TARGET[k]).conjugate()
        found.append(((turn.imag / abs(turn)) ** 2, w.real, w.imag))
    return found


def velocities(xp, x, y):
    """What the law asks of the points at x and y (..., 6), m/s: as many x, and y. ``xp``: cos, sin, stack and zeros."""
    ux, uy = [xp.zeros_like(x[..., 0])] * 2, [xp.zeros_like(x[..., 0])] * 2
    for (i, j, k), (rate, re, im) in zip(FOLLOWERS, constants(), strict=True):
        dx, dy = x[..., j] - x[..., i], y[..., j] - y[..., i]
        ux.append(rate * (x[..., i] - x[..., k] + re * dx - im * dy))
        uy.append(rate * (y[..., i] - y[..., k] + re * dy + im * dx))
    return xp.stack(ux, -1), xp.stack(uy, -1)


def commands(xp, x, y, theta):
    """(v, omega) of robots whose axles are at x, y and theta (..., 6): law and near-identity map."""
    c, s = xp.cos(theta), xp.sin(theta)
    ux, uy = velocities(xp, x + AHEAD * c, y + AHEAD * s)
    return ux * c + uy * s, (uy * c - ux * s) / AHEAD


def told(package: str, version: str, work, *sizes: tuple[int, int]) -> None:
    """Print the least processor time of ``work(runs, steps)``, seconds a step of all runs, after a first one."""
    rows = []
    for runs, steps in sizes:
        work(runs, steps)
        best = min(_timed(work, runs, steps) for _ in range(REPEATS))
        rows.append({"runs": runs, "seconds_a_step": best / steps})
    json.dump({"package": package, "version": version, "rows": rows}, sys.stdout)


def _timed(work, runs: int, steps: int) -> float:
    begin = time.process_time()
    work(runs, steps)
    return time.process_time() - begin
