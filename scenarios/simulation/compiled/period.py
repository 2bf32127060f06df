"""Control periods of many runs, compiled: sense, law, v_r, safety filter, NID, wheels, state.

The law comes from ``formation``, the filter and the drive from ``robots``; here they are only put in order. Nothing
here looks at what the runs achieve.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formation.laws import angle_loop
from formation.laws.angle_loop import Gains
from robots.compiled import compiled, inlined, program
from robots.safety.rows import Constants, Things
from robots.safety.step import Code, Room, filter_step
from robots.senses.measure import measure
from robots.senses.noise import Noise
from robots.worlds.bodies import Chassis, shove
from robots.worlds.lanes import COS, GX, GY, NOW, PX, SIN, UX, UY, VX, VY, WX, WY, Wheels, X, roll

Real = NDArray[np.float64]
Index = NDArray[np.int64]


class Commands(NamedTuple):
    """What a phase commands: v_r (m/s) and delta (m), in the common frame, and the control period, seconds."""

    velocity_x: float
    velocity_y: float
    delta_x: float
    delta_y: float
    period: float


class Guard(NamedTuple):
    """The safety filter; ``present`` is False for none."""

    present: bool
    constants: Constants
    things: Things
    room: Room


class Law(NamedTuple):
    """The law, its edges (m, 2), rows (observer, observed), and room (2, m, L) for what is measured along them."""

    gains: Gains
    edges: Index
    seen: Real


_feedback = compiled(angle_loop.feedback)


@program
def advance(
    state: Real,
    rows: Real,
    blockers: Code,
    law: Law,
    noise: Noise,
    commands: Commands,
    guard: Guard,
    wheels: Wheels,
    chassis: Chassis,
) -> None:
    """As many control periods as ``rows`` has room for, of robots with wheels.

    Args:
        state: (FIELDS, n, L), advanced in place; see :mod:`robots.worlds.lanes`.
        rows: (K, F, n, L) out: the first F fields of the state after each period.
        noise: with keys (K, L), of each period.
        blockers: (K, n, L, 3) out, see :func:`robots.safety.step.filter_step`; or (1, n, L, 3) for the last period's.
    """
    for k in range(len(rows)):
        heard = Noise(noise.keys[k], noise.position, noise.bearing)
        _obey(state, law, heard, commands)
        if guard.present:
            after = blockers[k % len(blockers)]
            filter_step(state, after, commands.period, NOW, guard.constants, guard.things, heard, guard.room)
        else:
            _copy(state, WX, state, UX, 2)
        if chassis.substeps > 0:
            shove(state, wheels, chassis, commands.period)
        else:
            roll(state, wheels, commands.period)
        _copy(state, 0, rows[k], 0, rows.shape[1])


@program
def integrate(state: Real, rows: Real, law: Law, noise: Noise, commands: Commands, room: Real) -> None:
    """The same of points that move as they will, dp/dt = u, by the classical Runge-Kutta method of order four.

    Args:
        room: (3, 2, n, L) for what the method remembers.
    """
    h = commands.period
    start, total, slope = room[0], room[1], room[2]
    for k in range(len(rows)):
        _copy(state, PX, start, 0, 2)
        heard = Noise(noise.keys[k], noise.position, noise.bearing)
        for stage in range(4):
            _obey(state, law, heard, commands)
            _copy(state, WX, state, UX, 2)
            _turn_out(state, slope)
            if stage == 0:
                _copy(slope, 0, total, 0, 2)
                _go(state, start, slope, h / 2.0)
            elif stage < 3:
                _add(total, slope, 2.0)
                _go(state, start, slope, h / 2.0 if stage == 1 else h)
            else:
                _add(total, slope, 1.0)
        _go(state, start, total, h / 6.0)
        _copy(state, PX, state, X, 2)
        _copy(state, 0, rows[k], 0, rows.shape[1])


@compiled
def _obey(state: Real, law: Law, noise: Noise, commands: Commands) -> None:
    """What the law and the commanded v_r ask of each robot, in its body frame."""
    e = law.seen
    measure(state, law.edges, NOW, noise, e)
    c, s, gx, gy = state[COS], state[SIN], state[GX], state[GY]
    _feedback(e, c, s, law.gains, commands.delta_x, commands.delta_y, gx, gy)
    vx, vy = commands.velocity_x, commands.velocity_y
    for i in range(state.shape[1]):
        for m in range(state.shape[2]):
            state[VX, i, m], state[VY, i, m] = vx * c[i, m] + vy * s[i, m], vy * c[i, m] - vx * s[i, m]
            state[WX, i, m], state[WY, i, m] = gx[i, m] + state[VX, i, m], gy[i, m] + state[VY, i, m]


@compiled
def _turn_out(state: Real, slope: Real) -> None:
    """The commands in the common frame."""
    for i in range(state.shape[1]):
        for m in range(state.shape[2]):
            ux, uy, c, s = state[UX, i, m], state[UY, i, m], state[COS, i, m], state[SIN, i, m]
            slope[0, i, m], slope[1, i, m] = ux * c - uy * s, ux * s + uy * c


@compiled
def _go(state: Real, start: Real, slope: Real, step: float) -> None:
    """Place the points at ``start`` plus ``step`` times ``slope``."""
    for axis in range(2):
        for i in range(state.shape[1]):
            for m in range(state.shape[2]):
                state[PX + axis, i, m] = start[axis, i, m] + step * slope[axis, i, m]


@inlined
def _copy(source: Real, first: int, into: Real, place: int, count: int) -> None:
    """Copy so many fields, from the ``first`` on; numpy's own assignment takes seconds to compile its error message."""
    for field in range(count):
        for i in range(source.shape[1]):
            for m in range(source.shape[2]):
                into[place + field, i, m] = source[first + field, i, m]


@compiled
def _add(total: Real, slope: Real, times: float) -> None:
    for axis in range(2):
        for i in range(total.shape[1]):
            for m in range(total.shape[2]):
                total[axis, i, m] += times * slope[axis, i, m]
