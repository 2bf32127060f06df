"""The testbed's rules: would the Robotarium accept this run?

A run is rejected when a robot's axle centre leaves the floor, or when two collision centres, each 0.025 m ahead of its
axle centre, come within 0.135 m of each other, or to just that (``rps`` 2.1). Ours, by the same measure: when one comes
within half of that of an obstacle. A wheel command beyond the limit is a warning: the testbed clips it. Each kind of
violation is reported once, with its first and its worst occurrence and the number of steps it lasts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.drive import DifferentialDrive
from robots.model import COLLISION_CENTRE, GTERNAL

Real = NDArray[np.float64]
Kind = Literal["floor", "collision", "obstacle", "actuator"]

COLLISION_DISTANCE = 0.135
"""Metres between two collision centres, up to which the testbed rejects a run (``rps`` 2.1)."""

OBSTACLE_DISTANCE = COLLISION_DISTANCE / 2.0
"""Metres between a collision centre and an obstacle, up to which the verdict rejects a run."""


FEW = 12
"""Robots up to which all pairs are compared."""

TOGETHER = 4096
"""States whose pairs are compared at once."""

_ROUNDING = 1e-15  # share of the wheels' limit by which a command that was cut to the limit may be off


@dataclass(frozen=True)
class Occurrence:
    """A violation at one step.

    Attributes:
        time: seconds.
        robots: rows of the robots involved.
        place: (x, y), metres: the axle centre, the middle between the two collision centres, or the collision centre
            at an obstacle.
        value: what was found: the distance beyond the floor, between the centres or from the obstacle (m), or the wheel
            speed (rad/s).
    """

    time: float
    robots: tuple[int, ...]
    place: tuple[float, float]
    value: float


@dataclass(frozen=True)
class Violation:
    """One kind of violation.

    Attributes:
        kind: ``floor``, ``collision`` and ``obstacle`` reject the run, ``actuator`` is a warning.
        steps: number of recorded steps at which it holds.
        first: of all occurrences; of several robots at that step, the one that is worst off.
        worst: the furthest beyond the floor, the nearest to each other or to an obstacle, the fastest wheel; where the
            run ends in no number, that.
    """

    kind: Kind
    steps: int
    first: Occurrence
    worst: Occurrence


@dataclass(frozen=True)
class Verdict:
    """The testbed's answer. ``accepted`` is true when no violation rejects the run."""

    violations: tuple[Violation, ...]

    @property
    def accepted(self) -> bool:
        return all(v.kind == "actuator" for v in self.violations)


@dataclass(frozen=True)
class Separation:
    """Distance of the closest pair over time.

    Attributes:
        distance: (T,) metres; infinite for a single robot.
        pairs: (T, 2) rows of the closest pair.
    """

    distance: Real
    pairs: NDArray[np.intp]


def collision_centres(poses: Real) -> Real:
    """(..., 2) the points that the testbed checks for collisions, of poses (..., 3)."""
    theta = poses[..., 2]
    return poses[..., :2] + COLLISION_CENTRE * np.stack([np.cos(theta), np.sin(theta)], axis=-1)


def separation(centres: Real) -> Separation:
    """The closest pair at each time, of points (T, n, 2), metres; of several equally close the first one."""
    steps, n = centres.shape[:2]
    if n < 2:
        return Separation(np.full(steps, np.inf), np.zeros((steps, 2), dtype=np.intp))
    points = np.ascontiguousarray(centres)
    if n <= FEW:
        pairs = _by_all_pairs(points)
    else:
        from robots.closest_pairs import closest_pairs  # loads compiled code

        pairs = closest_pairs(points)
    one, other = (np.take_along_axis(centres, pairs[:, k, None, None], axis=1)[:, 0] for k in (0, 1))
    with np.errstate(invalid="ignore"):  # a state that is not finite has no separation
        gap = one - other
    return Separation(np.hypot(gap[:, 0], gap[:, 1]), pairs)


def _by_all_pairs(points: Real) -> NDArray[np.intp]:
    """(T, 2) what :func:`robots.closest_pairs.closest_pairs` finds, for few robots faster than compiled code loads."""
    one, other = np.triu_indices(points.shape[1], 1)
    pairs = np.empty((len(points), 2), dtype=np.intp)
    for first in range(0, len(points), TOGETHER):
        part = points[first : first + TOGETHER]
        with np.errstate(invalid="ignore", over="ignore"):
            gaps = np.hypot(*np.moveaxis(part[:, one] - part[:, other], -1, 0))
        closest = gaps.argmin(axis=1)
        pairs[first : first + TOGETHER] = np.stack([one[closest], other[closest]], axis=1)
    return pairs


def fastest_allowed(drive: DifferentialDrive) -> float | Real:
    """The wheel speed, rad/s, beyond which a command counts as beyond the limit; (n,) of robots that differ."""
    return drive.wheel_speed_limit * (1.0 + _ROUNDING)


def judge(
    t: Real,
    poses: Real,
    wheel_speeds: Real,
    floor: Arena = ROBOTARIUM_FLOOR,
    drive: DifferentialDrive = GTERNAL.drive,
    near: Separation | None = None,
    there: NDArray[np.bool_] | None = None,
) -> Verdict:
    """The verdict on a run: times (T,), poses (T, n, 3) of the axle centres and wheel speeds (T, n, 2).

    ``near`` is the separation of the collision centres where the caller has it already: it is the dear part. ``there``
    (T, O) says which obstacles stand at these times; all where absent.
    """
    x, y = poses[..., 0], poses[..., 1]
    beyond = np.max([floor.x[0] - x, x - floor.x[1], floor.y[0] - y, y - floor.y[1]], axis=0)
    centres = collision_centres(poses)
    if near is None:
        near = separation(centres)
    speed = np.abs(wheel_speeds).max(axis=-1)
    found = [
        _violation("floor", t, ~floor.contains(poses[..., :2]), beyond, beyond, poses[..., :2]),
        _collision(t, near, centres),
    ]
    if floor.obstacles:
        apart = np.stack([obstacle.distance(centres) for obstacle in floor.obstacles])
        gaps = (apart if there is None else np.where(there.T[..., None], apart, np.inf)).min(axis=0)
        found.append(_violation("obstacle", t, gaps <= OBSTACLE_DISTANCE, gaps, -gaps, centres))
    fast = speed > fastest_allowed(drive)
    found.append(_violation("actuator", t, fast, speed, speed, poses[..., :2]))
    return Verdict(tuple(violation for violation in found if violation is not None))


def _violation(kind: Kind, t: Real, holds: NDArray[np.bool_], value: Real, bad: Real, place: Real) -> Violation | None:
    """Where ``holds`` (T, n) says so: the first and the worst, by ``bad`` (T, n), which grows as it gets worse."""
    steps = np.flatnonzero(holds.any(axis=1))
    if not steps.size:
        return None
    badness = np.where(holds, np.where(np.isnan(bad), np.inf, bad), -np.inf)

    def occurrence(k: int) -> Occurrence:
        robot = int(badness[k].argmax())
        x, y = place[k, robot].tolist()
        return Occurrence(float(t[k]), (robot,), (x, y), float(value[k, robot]))

    return Violation(kind, len(steps), occurrence(int(steps[0])), occurrence(int(badness.max(axis=1).argmax())))


def _collision(t: Real, near: Separation, centres: Real) -> Violation | None:
    steps = np.flatnonzero(near.distance <= COLLISION_DISTANCE)
    if not steps.size:
        return None

    def occurrence(k: int) -> Occurrence:
        i, j = near.pairs[k].tolist()
        x, y = centres[k, [i, j]].mean(axis=0).tolist()
        return Occurrence(float(t[k]), (i, j), (x, y), float(near.distance[k]))

    worst = int(steps[near.distance[steps].argmin()])
    return Violation("collision", len(steps), occurrence(int(steps[0])), occurrence(worst))
