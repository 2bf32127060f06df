"""What the linearised loop makes of delay, of errors and of noise: the closed forms of the analysis, for any law.

Only agents whose every mode decays are looked at: along what a law leaves free, noise makes a formation wander without
end. That part has to stand alone, as it does in a cascade.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formation.analysis.cascade import exponential
from formation.analysis.margins import delay_margin, most_periods
from formation.audit.subject import STEPS, Finding, Subject
from formation.measurements import perfect
from formation.plane import Real

DOUBLINGS = 40
"""Of the sum that solves the covariance's equation: beyond any rate that a run could tell from 0."""

LOOKS = 400
"""Instants at which the growth of errors is looked at, a quarter of the fastest mode's time apart."""

UNKNOWN = "unknown: the derivative is, or what decays does not stand alone"


@dataclass(frozen=True, eq=False)
class _Part:
    """The decaying part of the loop: dx/dt = matrix x + errors y, y what is wrong with the relative positions."""

    matrix: Real
    errors: Real


def delay(subject: Subject, control_period: float) -> Finding:
    """How late all measurements may be."""
    loop = subject.loop
    if not loop.smooth or not loop.moving.any():
        return Finding("delay", None, remark=UNKNOWN)
    modes = loop.modes[loop.moving]
    periods = most_periods(modes, control_period)
    held = (
        "no delay is stable" if periods is None or periods < 0 else f"{periods} control periods where commands are held"
    )
    return Finding("delay", None, delay_margin(modes), "s", f"that is stable; {held}")


def growth(subject: Subject) -> Finding:
    """How much errors may grow before they decay."""
    part = _decaying(subject)
    if part is None:
        return Finding("growth of errors", None, remark=UNKNOWN)
    matrix = part.matrix.astype(np.complex128)
    h = 0.25 / float(np.abs(np.linalg.eigvals(matrix)).max())
    step = exponential(lambda x: h * (matrix @ x), len(matrix), h * float(np.abs(matrix).sum(axis=1).max()))
    state, largest, when = np.eye(len(matrix), dtype=np.complex128), 1.0, 0.0
    for look in range(1, LOOKS):
        state = step @ state
        norm = float(np.linalg.norm(state, 2))
        if norm > largest:
            largest, when = norm, look * h
        if norm < 1.0:
            break
    remark = f"fold at most, after {when:.3g} s" if when else "fold: they decay from the start"
    return Finding("growth of errors", None, largest, "", remark)


def bias(subject: Subject) -> Finding:
    """How far constant errors of the relative positions leave an agent from its place."""
    part = _decaying(subject)
    if part is None:
        return Finding("bias", None, remark=UNKNOWN)
    offsets = np.linalg.solve(part.matrix, part.errors).reshape(-1, 2, part.errors.shape[1])
    worst = float(np.sqrt((offsets**2).sum(axis=(1, 2)) / 2.0).max())
    return Finding("bias", None, worst, "m/m", "of an agent's place, over independent ones of all relative positions")


def noise(subject: Subject, control_period: float) -> Finding:
    """The largest rms error of an agent, over the deviation of a coordinate that is drawn each period."""
    part = _decaying(subject)
    if part is None:
        return Finding("noise", None, remark=UNKNOWN)
    f = np.eye(len(part.matrix)) + control_period * part.matrix
    if not np.abs(np.linalg.eigvals(f)).max() < 1.0:
        return Finding("noise", None, remark="unknown: the loop is not stable at the control period")
    push = control_period * part.errors
    x = push @ push.T
    for _ in range(DOUBLINGS):
        x, f = x + f @ x @ f.T, f @ f
    rms = float(np.sqrt(np.diagonal(x).reshape(-1, 2).sum(axis=1).max()))
    return Finding("noise", None, rms, "m/m", "rms error of an agent, over a coordinate's deviation, new each period")


def _decaying(subject: Subject) -> _Part | None:
    loop = subject.loop
    if not loop.smooth:
        return None
    modes = loop.modes if loop.cascade else None
    if modes is None:
        return None
    agents = np.flatnonzero((modes.real < 0.0).all(axis=1) & loop.moving.all(axis=1))
    if not agents.size:
        return None
    rows = (2 * agents[:, None] + [0, 1]).ravel()
    return _Part(loop.matrix[np.ix_(rows, rows)], _by_errors(subject)[rows])


def _by_errors(subject: Subject) -> Real:
    """(2n, 2m) derivative of the velocities by the relative positions that are measured, 1/s."""
    observer, observed = subject.graph.edges.T
    relative = subject.positions[observed] - subject.positions[observer]
    _, compass = subject.measure(subject.positions)
    h = STEPS[1] * float(np.linalg.norm(relative, axis=1).min())
    slope = np.empty((subject.positions.size, relative.size))
    for column in range(relative.size):
        move = np.zeros(relative.size)
        move[column] = h
        ahead, behind = (
            subject.ask(perfect(subject.kinds, relative + sign * move.reshape(-1, 2), subject.graph.corners), compass)
            for sign in (1.0, -1.0)
        )
        slope[:, column] = (ahead - behind).ravel() / (2.0 * h)
    return slope
