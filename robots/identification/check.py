"""From raw arrays to a log: repaired where it is plain what happened, refused in one line where it is not."""

from __future__ import annotations

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import Log, LogError
from robots.identification.numbers import TURN
from robots.identification.odometry import RADIANS_PER_COUNT
from robots.model import GTERNAL

Real = NDArray[np.float64]

SHORTEST = 200
"""Turns below which slip and jitter cannot be told apart."""

COUNTER_RANGE = 1 << 16
"""Values of a 16-bit counter."""

QUANTA = (0.01, 0.001, 0.0001, np.radians(1.0), np.radians(0.1), np.radians(0.01))
"""Steps, radians, to which headings may be rounded."""

_LONGEST_SILENCE = 40  # turns' worth of counts that one reading may bring
_FASTEST = GTERNAL.drive.wheel_speed_limit * TURN / RADIANS_PER_COUNT  # counts per turn
_JUMP = 0.25  # metres from one turn to the next: more than a second of driving at the wheels' limit
_FLOOR = 10.0  # metres that no testbed's floor reaches
_AGREE = 0.8  # correlation of wheels and cameras over a few turns; above 0.95 in the log of a real robot
_WINDOW = 5
_AXES = ("x", "y", "theta")


def checked(poses: Real, counts: Real) -> Log:
    """A log from poses (T, 3) and encoder counts (T, 2), left and right.

    Repaired, and said: turns without a value, 16-bit counters that wrap, headings that wrap or are in degrees, left and
    right exchanged, both counters' signs turned round.

    Raises:
        LogError: too short, at rest, poses or counts that jump, columns in another order, or counts and poses that do
            not belong to one robot.
    """
    if poses.ndim != 2 or poses.shape[1] != 3 or counts.shape != (len(poses), 2):
        raise LogError(f"expected poses (T, 3) and counts (T, 2), got {poses.shape} and {counts.shape}")
    repairs: list[str] = []
    poses, counts = _without_gaps(np.array(poses, dtype=float), np.array(counts, dtype=float), repairs)
    counts = _continuous(counts, repairs)
    _check_positions(poses)
    return _one_robot(poses, counts, repairs)


def _without_gaps(poses: Real, counts: Real, repairs: list[str]) -> tuple[Real, Real]:
    good = []
    for name, values in (("poses", poses), ("counts", counts)):
        values[~np.isfinite(values).all(axis=1)] = np.nan
        good.append(np.isfinite(values[:, 0]))
        if lost := int((~good[-1]).sum()):
            repairs.append(f"{lost} of {len(values)} turns have no {name}: taken as lost messages")
    both = good[0] & good[1]
    if (turns := int(both.sum())) < SHORTEST:
        raise LogError(f"expected at least {SHORTEST} turns with poses and counts, got {turns}")
    first = int(both.argmax())
    return poses[first:], counts[first:]


def _continuous(counts: Real, repairs: list[str]) -> Real:
    rows = np.flatnonzero(np.isfinite(counts[:, 0]))
    steps = np.diff(counts[rows], axis=0)
    wraps = np.rint(steps / COUNTER_RANGE)
    if wraps.any():
        steps = steps - COUNTER_RANGE * wraps
        repairs.append(f"16-bit counters wrap {int(np.abs(wraps).sum())} times: made continuous")
    for side, name in enumerate(("left", "right")):
        if not steps[:, side].any():
            raise LogError(f"the {name} encoder's counts never change, expected wheels that turn")
    fast = np.abs(steps).max(axis=1) > (_LONGEST_SILENCE + np.diff(rows)) * _FASTEST
    if fast.any():
        at = int(fast.argmax())
        raise LogError(
            f"the counts jump by {np.abs(steps[at]).max():.0f} at turn {rows[at + 1]}, expected a few times "
            f"{_FASTEST:.0f}: two robots mixed, or a counter that was reset"
        )
    counts[rows[1:]] = counts[rows[0]] + np.cumsum(steps, axis=0)
    return counts


def _check_positions(poses: Real) -> None:
    rows = np.flatnonzero(np.isfinite(poses[:, 0]))
    known = poses[rows, :2]
    if np.abs(known).max() > _FLOOR:
        raise LogError(f"positions reach {np.abs(known).max():.4g}, expected metres on the testbed's floor")
    jumps = np.hypot(*np.diff(known, axis=0).T)
    if (far := jumps > _JUMP * np.diff(rows)).any():
        at = int(far.argmax())
        raise LogError(
            f"the robot jumps by {jumps[at]:.2f} m at turn {rows[at + 1]}, expected less than {_JUMP} m: two robots "
            "mixed, or columns that are not x, y, theta"
        )


def _one_robot(poses: Real, counts: Real, repairs: list[str]) -> Log:
    """Find out in which unit the headings are and which way round the counters, by what wheels and cameras agree on."""
    rows = np.flatnonzero(np.isfinite(poses[:, 0]) & np.isfinite(counts[:, 0]))
    known, angles = poses[rows], RADIANS_PER_COUNT * (counts[rows] - counts[rows[0]])
    # Rounding of counts and poses to whole turns does not matter over a window.
    turned, forward = _over(angles[:, 1] - angles[:, 0]), _over(angles.sum(axis=1)) / 2.0
    radians, degrees = np.unwrap(known[:, 2]), np.radians(np.unwrap(known[:, 2], period=360.0))
    in_degrees = abs(_agreement(turned, _over(degrees))) > abs(_agreement(turned, _over(radians))) and (
        float(np.abs(known[:, 2]).max()) > 2.0 * np.pi
    )
    theta = degrees if in_degrees else radians
    turning, driving = _agreement(turned, _over(theta)), _agreement(forward, _ahead(known, theta))
    if min(abs(turning), abs(driving)) < _AGREE:
        across, along = _agreement(forward, _over(theta)), _agreement(turned, _ahead(known, theta))
        if min(abs(across), abs(along)) > _AGREE:  # one counter's sign exchanges sum and difference
            raise LogError("one encoder counts backwards: sum and difference of the counts are exchanged")
        raise LogError(_disagreement(known, turned, forward, turning, driving))
    if in_degrees:
        repairs.append("headings are in degrees: converted")
    if driving < 0.0:
        counts = -counts
        repairs.append("both encoders count backwards: signs turned round")
    if turning * driving < 0.0:
        counts = counts[:, ::-1]
        repairs.append("left and right encoder are exchanged: put right")
    quantum = _quantum(np.radians(known[:, 2]) if in_degrees else known[:, 2])
    poses[rows, 2] = theta
    alone = np.setdiff1d(np.flatnonzero(np.isfinite(poses[:, 0])), rows)  # seen, but without counts
    near = np.interp(alone, rows, theta)
    poses[alone, 2] = near + _wrapped((np.radians(poses[alone, 2]) if in_degrees else poses[alone, 2]) - near)
    return Log(poses, counts, quantum, tuple(repairs))


def _wrapped(angle: Real) -> Real:
    return np.asarray(np.remainder(angle + np.pi, 2.0 * np.pi) - np.pi)


def _disagreement(known: Real, turned: Real, forward: Real, turning: float, driving: float) -> str:
    for order in permutations(range(3)):
        other = known[:, order]
        theta = np.unwrap(other[:, 2])
        if min(abs(_agreement(turned, _over(theta))), abs(_agreement(forward, _ahead(other, theta)))) > _AGREE:
            columns = [""] * 3
            for place, axis in zip(order, _AXES, strict=True):
                columns[place] = axis
            return f"the poses' columns look like {', '.join(columns)}, expected x, y, theta"
    return (
        f"wheels and cameras disagree: correlation {turning:.2f} in turning, {driving:.2f} in driving, expected above "
        f"{_AGREE}: counts and poses of different robots, or exchanged columns"
    )


def _over(values: Real) -> Real:
    return values[_WINDOW:] - values[:-_WINDOW]


def _ahead(poses: Real, theta: Real) -> Real:
    """How far the poses go along their headings over a window."""
    middle = theta[_WINDOW // 2 : _WINDOW // 2 - _WINDOW]
    step = _over(poses[:, :2])
    return step[:, 0] * np.cos(middle) + step[:, 1] * np.sin(middle)


def _agreement(a: Real, b: Real) -> float:
    """The correlation of two ways, at the lag of up to three turns that suits them best."""
    best = 0.0
    for lag in range(-3, 4):
        one, other = (a[lag:], b[: len(b) - lag]) if lag >= 0 else (a[:lag], b[-lag:])
        norm = float(np.sqrt((one @ one) * (other @ other)))
        found = float(one @ other) / norm if norm > 0.0 else 0.0
        best = found if abs(found) > abs(best) else best
    return best


def _quantum(headings: Real) -> float:
    """The largest of :data:`QUANTA` of which all headings are multiples; 0 where none is."""
    for quantum in sorted(QUANTA, reverse=True):
        steps = headings / quantum
        if np.abs(steps - np.rint(steps)).max() < 0.02:
            return float(quantum)
    return 0.0
