"""Where robots begin, and how the testbed brings them there from their chargers."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robots.rps.columns import Real, wrapped
from robots.rps.simulation import Simulation
from robots.rps.version2.barrier_certificates import create_uni_barrier_certificate
from robots.rps.version2.controllers import create_pose_controller_hybrid
from robots.rps.version2.misc import create_at_pose, generate_random_poses

MOST_ROBOTS = 50
"""Robots that the testbed has."""

POSITION_ERROR, ROTATION_ERROR = 0.05, 0.2
"""Metres and radians within which the testbed brings robots to their start (``rps`` 2.1)."""

LONGEST_DRIVE = 18_000
"""Steps, ten minutes, after which robots on their way to the start are stuck: ``rps`` has no such limit."""

WAIT, STIR, NUDGE = 150, 0.1, 0.25
"""Steps for which a robot moves less than ``STIR``, metres, before it drives to a place within ``NUDGE`` first."""

FORGOTTEN, FORGOTTEN_WAIT = (0, 1), 1500
"""Whom ``rps`` forgets, and how many steps they wait instead."""

QUIET = 0.1
"""Of a wish, (v, omega) in m/s and rad/s, below which a robot is not held up but about to arrive."""

_GRID = (10, 5)  # one place for each of 50 robots: 0.3 m apart along x, 0.4 m along y
_GRID_REACH = (1.35, 0.8)
_JITTER = 0.05


class StuckError(RuntimeError):
    """Robots have not come to their start."""


def given_poses(number: int, given: ArrayLike | None) -> tuple[int, Real | None]:
    """How many robots there are, and the poses (N, 3) that they were given, None where they are to be drawn.

    Raises:
        ValueError: no such number of robots, or poses that have another shape or are not finite.
    """
    columns = np.empty(0) if given is None else np.asarray(given, dtype=np.float64)
    if columns.size and (columns.ndim != 2 or len(columns) != 3):
        raise ValueError(f"initial_conditions must have the shape (3, N), got {columns.shape}")
    if not np.isfinite(columns).all():
        raise ValueError("initial_conditions must be finite")
    n = columns.shape[1] if columns.size and number == -1 else int(number)
    if not 1 <= n <= MOST_ROBOTS:
        raise ValueError(f"number_of_robots must be 1 to {MOST_ROBOTS}, got {n}")
    if not columns.size:
        return n, None
    if columns.shape[1] != n:
        raise ValueError(f"initial_conditions must have the shape (3, {n}), got {columns.shape}")
    return n, np.ascontiguousarray(columns.T)


def generator(seed: int) -> Any:
    """A generator of numpy's old kind, whose methods the sensors share with ``np.random``."""
    return np.random.RandomState(np.random.MT19937(np.random.SeedSequence(seed)))


def scattered(n: int, draws: Any) -> Real:
    """(n, 3) random poses for any number of robots, no two collision centres closer than 0.15 m."""
    column, row = np.divmod(draws.permutation(_GRID[0] * _GRID[1])[:n], _GRID[1])
    places = np.stack([column / (_GRID[0] - 1), row / (_GRID[1] - 1)], axis=1)
    points = (2.0 * places - 1.0) * _GRID_REACH + draws.uniform(-_JITTER, _JITTER, (n, 2))
    return np.concatenate([points, draws.uniform(-np.pi, np.pi, (n, 1))], axis=1)


def near(poses: Real, draws: np.random.Generator) -> Real:
    """(N, 3) poses anywhere within the testbed's tolerance of ``poses``."""
    n = len(poses)
    reach, bearing = POSITION_ERROR * np.sqrt(draws.uniform(size=n)), draws.uniform(-np.pi, np.pi, n)
    turn = draws.uniform(-ROTATION_ERROR, ROTATION_ERROR, n)
    return poses + np.stack([reach * np.cos(bearing), reach * np.sin(bearing), turn], axis=1)


def drive_in(simulation: Simulation, goals: Real, boundaries: Real, stepped: Callable[[], None]) -> int:
    """Drive robots from where they stand to within the testbed's tolerance of goals (N, 3); the steps it took.

    As ``rps`` 2.1 does: the hybrid controller and the unicycle certificate, and for who is held up a place nearby to
    drive to first. There a mask is taken for numbers, which looks after robots that have arrived too and keeps 0 and 1
    from being looked after at all; here it is those that have not arrived, these two after ten times as long.

    Args:
        simulation: what drives.
        goals: (N, 3).
        boundaries: x low, x high, y low, y high, metres.
        stepped: called after each step.

    Raises:
        StuckError: they have not arrived in :data:`LONGEST_DRIVE` steps, naming who has not.
    """
    n, target = len(goals), goals.T
    certificate = create_uni_barrier_certificate()
    controller = create_pose_controller_hybrid(
        angular_velocity_limit=np.pi / 3.0, position_epsilon=0.03, position_error=0.05, rotation_error=0.1
    )
    arrived = create_at_pose(POSITION_ERROR, ROTATION_ERROR)
    detour = np.full((3, n), np.nan)
    since, held_at = np.zeros(n, dtype=np.intp), simulation.poses.T.copy()
    with suppress(ValueError):  # places that rps draws here and does not use: what follows is drawn alike
        generate_random_poses(n, spacing=0.4, width=2.75, height=1.75)
    x = _columns(simulation)
    simulation.step(np.zeros((n, 2)))
    stepped()
    for step in range(LONGEST_DRIVE):
        done, who = arrived(x, target)
        if done:
            return step
        x = _columns(simulation)
        _, who = arrived(x, target)
        # In rps the controller's memory is lost at every step.
        wish, _ = controller(x, target, np.ones(n))
        quiet = np.linalg.norm(wish, axis=0) <= QUIET
        around, _ = controller(x, np.where(np.isnan(detour), target, detour), np.ones(n))
        moved = np.linalg.norm(x[:2] - held_at[:2], axis=0)
        for robot in np.flatnonzero(~who):
            waits = step - since[robot] > (FORGOTTEN_WAIT if robot in FORGOTTEN else WAIT)
            if not np.isnan(detour[0, robot]):
                wish[:, robot] = around[:, robot]
                if moved[robot] > STIR:
                    detour[:, robot] = np.nan
                elif waits:
                    detour[:, robot], since[robot] = _nearby(x[:2, robot], boundaries), step
            elif waits and moved[robot] < STIR:
                detour[:, robot], since[robot] = _nearby(x[:2, robot], boundaries), step
            elif moved[robot] > STIR or quiet[robot]:
                since[robot], held_at[:, robot] = step, x[:, robot]
        simulation.step(certificate(wish, x).T)
        stepped()
    missing = ", ".join(str(robot) for robot in np.flatnonzero(~who))
    raise StuckError(f"robots {missing} have not come to their start in {LONGEST_DRIVE} steps: it is too crowded there")


def _columns(simulation: Simulation) -> Real:
    """(3, N) poses, headings wrapped."""
    x, y, theta = simulation.poses.T
    return np.stack([x, y, wrapped(theta)])


def _nearby(place: Real, boundaries: Real) -> Real:
    """A pose within reach of a place (2,), on the floor, drawn as ``rps`` draws it."""
    low_x, high_x, low_y, high_y = boundaries
    x, y = place
    return np.array(
        [
            np.random.uniform(min(x + NUDGE, high_x), max(x - NUDGE, low_x)),  # noqa: NPY002
            np.random.uniform(min(y + NUDGE, high_y), max(y - NUDGE, low_y)),  # noqa: NPY002
            np.random.uniform(-np.pi, np.pi),  # noqa: NPY002
        ]
    )
