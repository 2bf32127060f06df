"""A trajectory from the compiled period: what :mod:`scenarios.simulation.loop` records step by step. No measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from robots.safety.protocol import BLOCKERS
from scenarios.definition.experiment import Experiment
from scenarios.simulation.compiled.runs import Chunk, Runs
from scenarios.simulation.schedule import times
from scenarios.simulation.trajectory import OnPeriod, OnState, Real, Trajectory

CHUNK = 64
"""Periods between two looks at the runs, where nobody wants to see each of them."""


def record(
    experiment: Experiment,
    seeds: Sequence[int],
    on_period: OnPeriod | None = None,
    on_state: OnState | None = None,
    alone: bool = False,
) -> Trajectory:
    """The trajectories of runs, (T, L, n, ...), or that of an ``alone`` one, (T, n, ...).

    See :func:`scenarios.simulation.loop.simulate`.
    """
    runs = Runs(experiment, seeds)
    room = _room(experiment, runs.state)
    trajectory = room.run(0) if alone else room  # a view
    last = len(trajectory.t) - 1
    for chunk in runs.advance(CHUNK if on_state is None else 1, recorded=True):
        end = _take(room, chunk)
        for done in range(chunk.first, end + 1):
            if on_period is not None:
                on_period(done, last)
            if on_state is not None:
                on_state(trajectory, done)
        if not np.isfinite(trajectory.poses[end].sum()):
            return trajectory.until(end + 1)
    return trajectory


def as_batch(trajectories: Sequence[Trajectory]) -> Trajectory:
    """The runs (T, 1, n, ...) of one experiment as one batch, as long as the shortest of them."""
    rows = min(len(each.t) for each in trajectories)
    parts = [each.until(rows) for each in trajectories]
    rest = [field.name for field in fields(Trajectory) if field.name not in ("t", "phase")]
    return replace(parts[0], **{name: np.concatenate([getattr(each, name) for each in parts], 1) for name in rest})


def _room(experiment: Experiment, state: Real) -> Trajectory:
    """Room for all states, the first row of which is a state (FIELDS, n, L)."""
    t, phase = times(experiment)
    shape = (len(t), state.shape[2], state.shape[1])
    room = Trajectory(
        t=t,
        poses=np.empty((*shape, 3)),
        points=np.empty((*shape, 2)),
        wheel_speeds=np.empty((*shape, 2)),
        phase=phase,
        contact=np.empty(shape, dtype=np.intp),
        active=np.empty(shape, dtype=bool),
        intervention=np.zeros(shape),
        relaxation=np.zeros(shape),
        blockers=np.full((*shape, BLOCKERS), -1, dtype=np.int32),
        stuck=np.zeros(shape),
        wish=np.zeros((*shape, 2)),
        command=np.zeros((*shape, 2)),
    )
    _put(room, slice(0, 1), state[None])
    return room


def _take(room: Trajectory, chunk: Chunk) -> int:
    """Record a chunk; the last row that counts: that of the first state that is not finite, or the last."""
    rows = slice(chunk.first, chunk.first + len(chunk.rows))
    _put(room, rows, chunk.rows)
    room.blockers[rows] = chunk.blockers[: len(chunk.rows)].transpose(0, 2, 1, 3)
    broken = np.flatnonzero(~np.isfinite(room.poses[rows].sum(axis=(1, 2, 3))))
    return chunk.first + int(broken[0]) if broken.size else rows.stop - 1


def _put(room: Trajectory, rows: slice, states: Real) -> None:
    """Write states (K, F, n, L) into rows."""
    from robots.worlds.lanes import ACTIVE, CONTACT, INTERVENTION, LEFT, PX, RELAXATION, STUCK, UX, WX, X

    each = states.transpose(0, 3, 2, 1)  # (K, L, n, F)
    room.poses[rows] = each[..., X : X + 3]
    room.points[rows] = each[..., PX : PX + 2]
    room.wheel_speeds[rows] = each[..., LEFT : LEFT + 2]
    room.intervention[rows] = each[..., INTERVENTION]
    room.relaxation[rows] = each[..., RELAXATION]
    room.stuck[rows] = each[..., STUCK]
    room.contact[rows] = each[..., CONTACT]
    room.active[rows] = each[..., ACTIVE] > 0.0
    room.wish[rows] = each[..., WX : WX + 2]
    room.command[rows] = each[..., UX : UX + 2]
