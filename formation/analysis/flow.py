"""Ideal integrators from many starts at once: each run has its own step, and leaves when it rests.

The pair of Bogacki and Shampine, of orders three and two: laws differ in speed by orders of magnitude from start to
start, and near its rest an explicit method's step is bounded by stability, which few stages serve best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation.graph.edges import Index
from formation.plane import Real

FIRST_STEP, LARGEST_STEP = 1e-3, 1.0
"""Seconds."""

FARTHEST = 1e4
"""Metres from the origin, beyond which a run counts as diverged."""

SAFETY, MOST_GROWTH, LEAST_GROWTH = 0.9, 4.0, 0.2
"""Of the step that the error allows, and bounds on how much a step changes."""

SMALLEST_STEP = 2e-3
"""Seconds, far below any robot's control period: a run that needs a smaller one is advanced by it all the same.

Bearings of an agent that rides on another one change without bound."""


@dataclass(frozen=True, eq=False)
class Flow:
    """Where many runs end.

    Attributes:
        points: (runs, n, 2) metres; not finite where a law gave no number.
        velocity: (runs, n, 2) of the agents there, m/s.
        time: (runs,) seconds, the horizon where a run did not rest.
        settled: (runs,) seconds after which ``near`` held until the end; infinite where it does not hold at the end.
    """

    points: Real
    velocity: Real
    time: Real
    settled: Real

    @property
    def speed(self) -> Real:
        """(runs,) greatest speed of an agent, m/s."""
        greatest: Real = np.linalg.norm(self.velocity, axis=2).max(axis=1)
        return greatest

    @property
    def drift(self) -> Real:
        """(runs,) speed of the formation's centre, m/s."""
        centre: Real = np.linalg.norm(self.velocity.mean(axis=1), axis=1)
        return centre

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """(runs,) which runs left for infinity or for no number at all."""
        return ~(np.abs(self.points).max(axis=(1, 2)) < FARTHEST)


@np.errstate(all="ignore")
def flow(
    velocity: Callable[[Real, Index], Real],
    start: Real,
    horizon: float,
    near: Callable[[Real], NDArray[np.bool_]],
    tolerance: float = 1e-7,
    smallest: float = SMALLEST_STEP,
    rest: float = 1e-5,
    on_progress: Callable[[float], None] | None = None,
) -> Flow:
    """Advance dp/dt = velocity(p) from starts (runs, n, 2), metres, until all rest or the horizon, seconds.

    Args:
        velocity: of points (r, n, 2) of the runs with the indices (r,), m/s.
        start: (runs, n, 2).
        horizon: seconds.
        near: whether points (r, n, 2) are at the goal.
        tolerance: metres of error in one step.
        smallest: step, seconds; see :data:`SMALLEST_STEP`.
        rest: m/s; a run whose agents are all slower stands.
        on_progress: called with the share of the work that is done, between 0 and 1.
    """
    points = np.array(start, dtype=np.float64)
    runs = len(points)
    time, step = np.zeros(runs), np.full(runs, max(FIRST_STEP, smallest))
    left_goal = np.where(near(points), -1.0, 0.0)
    slope = velocity(points, np.arange(runs))
    live = np.arange(runs)
    while live.size:
        p, h, k1 = points[live], np.minimum(step[live], horizon - time[live])[:, None, None], slope[live]
        k2 = velocity(p + 0.5 * h * k1, live)
        k3 = velocity(p + 0.75 * h * k2, live)
        new = p + h * (2.0 * k1 + 3.0 * k2 + 4.0 * k3) / 9.0
        k4 = velocity(new, live)
        error = np.abs(h * (-5.0 * k1 + 6.0 * k2 + 8.0 * k3 - 9.0 * k4) / 72.0).max(axis=(1, 2))
        h = h[:, 0, 0]
        taken = ~(error > tolerance) | (h <= smallest)
        growth = SAFETY * np.cbrt(tolerance / np.maximum(error, 1e-30))
        step[live] = np.clip(h * np.clip(growth, LEAST_GROWTH, MOST_GROWTH), smallest, LARGEST_STEP)
        moved = live[taken]
        points[moved], slope[moved] = new[taken], k4[taken]
        time[moved] += h[taken]
        left_goal[moved] = np.where(near(new[taken]), left_goal[moved], time[moved])
        speed = np.linalg.norm(k4[taken], axis=2).max(axis=1)
        far = ~(np.abs(new[taken]).max(axis=(1, 2)) < FARTHEST)
        done = np.isin(live, moved[(speed < rest) | far | (time[moved] >= horizon - 1e-12)])
        live = live[~done]
        if on_progress is not None:
            on_progress(1.0 if not live.size else float(np.minimum(time[live] / horizon, 1.0).min()))
    settled = np.where(near(points), np.maximum(left_goal, 0.0), np.inf)
    return Flow(points, slope, time, settled)
