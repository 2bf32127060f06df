"""Control periods of many runs, compiled: sense, law, v_r, safety filter, NID, wheels, state.

The law comes from ``formation``, the filter and the drive from ``robots``; here they are only put in order. Nothing
here looks at what the runs achieve.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formation.laws import activation_loop, angle_loop
from formation.laws.angle_loop import Gains
from robots.compiled import compiled, inlined, program
from robots.safety.rows import Constants, Things
from robots.safety.step import Code, Room, filter_step
from robots.senses.late import Late, remember
from robots.senses.measure import measure
from robots.senses.noise import Noise
from robots.worlds.bodies import Chassis, shove
from robots.worlds.lanes import ACTIVE, COS, GX, GY, PX, SETTLED, SIN, UX, UY, VX, VY, WX, WY, Wheels, X, roll

Real = NDArray[np.float64]
Index = NDArray[np.int64]


class Commands(NamedTuple):
    """What agents are told in K control periods of one length, at S instants of each, in the common frame.

    Robots with wheels act at the begin of a period; points at the begin, the middle and the end of each Runge-Kutta
    step, of which a period has S / 3.

    Attributes:
        velocity: (K, S, 1, 2) v_r, m/s, or (K, S, n, 2) as each agent has it.
        delta: (K, S, 2) metres; 0 where none is told.
        rate: (K, S, 2) mu, 1/s; 0 where agents are not told it.
        period: seconds.
    """

    velocity: Real
    delta: Real
    rate: Real
    period: float


class Guard(NamedTuple):
    """The safety filter; ``present`` is False for none."""

    present: bool
    constants: Constants
    things: Things
    room: Room


class Law(NamedTuple):
    """The law and what agents know.

    Attributes:
        gains: of the law.
        edges: (m, 2) along which it measures, rows (observer, observed).
        late: how old measurements are.
        settled: metres from its place below which a follower lets others begin; 0 where all begin at once.
        seen: (2, m, L) room for what is measured.
    """

    gains: Gains
    edges: Index
    late: Late
    settled: float
    seen: Real


_feedback = compiled(angle_loop.feedback)
_hold = compiled(activation_loop.hold)


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
        if len(law.late.states):
            remember(state, law.late)
        _obey(state, law, heard, commands, k, 0)
        if guard.present:
            after, senses = blockers[k % len(blockers)], law.late.senses
            filter_step(state, after, commands.period, senses, guard.constants, guard.things, heard, guard.room)
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
    instants = commands.delta.shape[1]
    h = commands.period / (instants // 3)
    start, total, slope = room[0], room[1], room[2]
    for k in range(len(rows)):
        heard = Noise(noise.keys[k], noise.position, noise.bearing)
        for first in range(0, instants, 3):
            _copy(state, PX, start, 0, 2)
            for stage in range(4):
                _obey(state, law, heard, commands, k, first + (stage + 1) // 2)
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
def _obey(state: Real, law: Law, noise: Noise, commands: Commands, k: int, instant: int) -> None:
    """What the law and v_r ask of each robot at an instant of period k, in its body frame: wish and command."""
    senses, e = law.late.senses, law.seen
    measure(state, law.edges, senses, noise, e)
    c, s, gx, gy = state[senses.frame], state[senses.frame + 1], state[GX], state[GY]
    delta, rate, velocity = commands.delta[k, instant], commands.rate[k, instant], commands.velocity
    _feedback(e, c, s, law.gains, delta[0], delta[1], rate[0], rate[1], gx, gy)
    if law.settled > 0.0:
        _hold(gx, gy, law.gains.factors, law.edges, law.settled, instant == 0, state[ACTIVE], state[SETTLED])
    for i in range(state.shape[1]):
        own = min(i, velocity.shape[2] - 1)
        vx, vy = velocity[k, instant, own, 0], velocity[k, instant, own, 1]
        for m in range(state.shape[2]):
            state[VX, i, m], state[VY, i, m] = vx * c[i, m] + vy * s[i, m], vy * c[i, m] - vx * s[i, m]
            wx, wy = gx[i, m] + state[VX, i, m], gy[i, m] + state[VY, i, m]
            state[WX, i, m], state[WY, i, m], state[UX, i, m], state[UY, i, m] = wx, wy, wx, wy


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
