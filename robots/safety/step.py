"""One period of the decentralised filter for all robots of all runs, compiled.

:mod:`robots.safety.rows` writes each robot's rows, :mod:`robots.safety.solver` solves them. Most robots need no solver:
one whose wish breaks no row goes where it wishes. So the wishes of all runs are tried together, as vectors over runs,
and only the robots with a broken row are solved, one by one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, inlined, program
from robots.safety.crowd import LARGE, around, fill_grid, in_rows, others
from robots.safety.protocol import BLOCKERS
from robots.safety.rows import CLOSE, LEVEL, MOST, NORMAL_X, NORMAL_Y, ROW, Constants, Things, rows_of
from robots.safety.solver import RELAXED, TIGHT, WHEEL_ROWS, project, wheel_rows, within_wheels
from robots.senses.noise import Noise
from robots.worlds.lanes import (
    GX,
    GY,
    INTERVENTION,
    RELAXATION,
    SIDE,
    STUCK,
    UX,
    UY,
    VX,
    VY,
    Senses,
    sine_cosine,
)

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Code = NDArray[np.int32]


class Room(NamedTuple):
    """Where the filter works; what it holds between two periods means nothing.

    Attributes:
        cells, order, first: (n, 3), (n,), (2^k + 1,) the grid of a crowd.
        found: (n,) who is near a robot.
        lanes: (m, ROW, L) a robot's rows in all runs.
        source: (m,) what they belong to.
        problem, work: (WHEEL_ROWS + m, 3) the rows of one run.
        wish_x, wish_y, broken: (L,) what a robot wishes in all runs, and whether that breaks a row.
    """

    cells: Index
    order: Index
    first: Index
    found: Index
    lanes: Real
    source: Index
    problem: Real
    work: Real
    wish_x: Real
    wish_y: Real
    broken: Real


def room(n: int, runs: int, things: Things) -> Room:
    """Room for n robots in so many runs among things."""
    most, buckets = n + len(things.walls) + len(things.radii), 2 ** (2 * n - 1).bit_length()
    return Room(
        cells=np.empty((n, 3), np.int64),
        order=np.empty(n, np.int64),
        first=np.empty(buckets + 1, np.int64),
        found=np.empty(n, np.int64),
        lanes=np.empty((most, ROW, runs)),
        source=np.empty(most, np.int64),
        problem=np.empty((WHEEL_ROWS + most, 3)),
        work=np.empty((WHEEL_ROWS + most, 3)),
        wish_x=np.empty(runs),
        wish_y=np.empty(runs),
        broken=np.empty(runs),
    )


@program
def filter_step(
    state: Real,
    blockers: Code,
    period: float,
    senses: Senses,
    constants: Constants,
    things: Things,
    noise: Noise,
    room: Room,
) -> None:
    """Set the commands UX, UY of all robots, and what the filter says of them.

    Args:
        state: (FIELDS, n, L); read are what is sensed, the law and v_r, advanced the stuck time and the side.
        blockers: (n, L, 3) out: what the rows of a relaxed problem belong to, robots 0..n-1, walls n..n+3, then
            obstacles; -1 where there is none.
        period: seconds.
        senses: which fields of the state are sensed.
        room: for so many robots, runs and things.
    """
    n, runs = state.shape[1], state.shape[2]
    large = n > LARGE and runs == 1
    cells, order, first, found = room.cells, room.order, room.first, room.found
    lanes, problem, work, source = room.lanes, room.problem, room.work, room.source
    wish_x, wish_y, broken = room.wish_x, room.wish_y, room.broken
    if large:
        there_x, there_y = state[senses.others, :, 0], state[senses.others + 1, :, 0]
        fill_grid(there_x, there_y, constants.sensing_range, cells, first, order)
    for i in range(n):
        speed, weight = constants.speed_limits[i], constants.turn_weights[i]
        _bound(state[GX, i], state[GY, i])
        _bound(state[VX, i], state[VY, i])
        if large:
            x, y = state[senses.own, i, 0], state[senses.own + 1, i, 0]
            count = around(x, y, constants.sensing_range, i, cells, first, order, found)
            in_rows(found, count)
        else:
            count = others(i, n, found)
        used = rows_of(state, i, found, count, senses, constants, things, noise, lanes, source)
        _crowding(lanes, used, state[GX, i], state[GY, i], broken)
        _wish(state, i, broken, constants, wish_x, wish_y)
        _breaks(lanes, used, wish_x, wish_y, speed, weight, broken)
        for m in range(runs):
            state[UX, i, m], state[UY, i, m], state[RELAXATION, i, m] = wish_x[m], wish_y[m], 0.0
            blockers[i, m] = -1
            if broken[m] > 0.0 and math.isfinite(wish_x[m] + wish_y[m]):
                _solve(lanes, used, source, m, speed, weight, problem, work, state, i, blockers[i, m])
        _judge(state, i, period, senses, constants, wish_x, wish_y)


@inlined
def _bound(x: Real, y: Real) -> None:
    """Shorten velocities to :data:`MOST` in their larger parts."""
    for m in range(len(x)):
        x[m], y[m] = bounded(x[m], y[m])


@inlined
def bounded(x: float, y: float) -> tuple[float, float]:
    """(x, y), m/s, shortened to :data:`MOST` in its larger part."""
    largest = max(abs(x), abs(y))
    share = MOST / largest if largest > MOST else 1.0
    return x * share, y * share


@inlined
def _crowding(rows: Real, used: int, gx: Real, gy: Real, crowding: Real) -> None:
    """How much the law drives at something near: 0 where nothing is sensed or it drives away, 1 head-on at contact."""
    crowding[:] = 0.0
    for r in range(used):
        row = rows[r]
        for m in range(len(crowding)):
            toward = -(row[NORMAL_X, m] * gx[m] + row[NORMAL_Y, m] * gy[m])
            crowding[m] = max(crowding[m], row[CLOSE, m] * toward)
    for m in range(len(crowding)):
        law = math.sqrt(gx[m] * gx[m] + gy[m] * gy[m])
        crowding[m] = crowding[m] / law if law > 0.0 else 0.0


@inlined
def _wish(state: Real, i: int, crowding: Real, constants: Constants, wish_x: Real, wish_y: Real) -> None:
    """Where robot i wishes to go: its law, turned where it is crowded or stuck, and scaled to the wheels."""
    speed, weight = constants.speed_limits[i], constants.turn_weights[i]
    for m in range(len(crowding)):
        wait = max(0.0, state[STUCK, i, m] - constants.stuck_time)
        turn = constants.turn * crowding[m] + min(constants.stuck_turn_limit, constants.stuck_turn_rate * wait)
        sine, cosine = sine_cosine(turn)
        sine *= state[SIDE, i, m]
        gx, gy, vx, vy = state[GX, i, m], state[GY, i, m], state[VX, i, m], state[VY, i, m]
        gx, gy = cosine * gx - sine * gy, sine * gx + cosine * gy
        share = within_wheels(vx, vy, gx, gy, speed, weight)
        wish_x[m], wish_y[m] = vx + share * gx, vy + share * gy


@inlined
def _breaks(rows: Real, used: int, x: Real, y: Real, speed: float, weight: float, broken: Real) -> None:
    """1 in the runs in which (x, y) breaks a row or the wheels' limits, else 0."""
    for m in range(len(broken)):
        broken[m] = 1.0 if abs(x[m]) + weight * abs(y[m]) - speed > TIGHT else 0.0
    for r in range(used):
        row = rows[r]
        for m in range(len(broken)):
            breaks = row[NORMAL_X, m] * x[m] + row[NORMAL_Y, m] * y[m] < row[LEVEL, m] - TIGHT
            broken[m] = 1.0 if breaks else broken[m]


@compiled
def _solve(
    rows: Real,
    used: int,
    source: Index,
    m: int,
    speed: float,
    weight: float,
    problem: Real,
    work: Real,
    state: Real,
    i: int,
    blockers: Code,
) -> None:
    """Replace the command of robot i in run m by the nearest one that its rows allow; say who relaxed them, if any."""
    wheel_rows(problem, speed, weight)
    count = WHEEL_ROWS + min(used, 0)  # a variable, so that numba compiles for one type
    for r in range(used):
        if rows[r, LEVEL, m] > -np.inf:
            problem[count, 0], problem[count, 1] = rows[r, NORMAL_X, m], rows[r, NORMAL_Y, m]
            problem[count, 2] = rows[r, LEVEL, m]
            count += 1
    ux, uy, delta = project(problem, count, work, speed, weight, state[UX, i, m], state[UY, i, m])
    state[UX, i, m], state[UY, i, m], state[RELAXATION, i, m] = ux, uy, delta
    if delta > 0.0:
        # The thresholds are lowered by now: the rows that decided are those without slack.
        found, row = 0, WHEEL_ROWS
        for r in range(used):
            if rows[r, LEVEL, m] > -np.inf:
                slack = problem[row, 0] * ux + problem[row, 1] * uy - problem[row, 2]
                if found < BLOCKERS and slack <= RELAXED:
                    blockers[found] = source[r]
                    found += 1
                row += 1


@inlined
def _judge(
    state: Real, i: int, period: float, senses: Senses, constants: Constants, wish_x: Real, wish_y: Real
) -> None:
    """How far the command is from the law within the wheels' limits, and for how long robot i has been stuck.

    A robot whose state is not finite gets no number.
    """
    own, frame, _ = senses
    for m in range(len(wish_x)):
        gx, gy, vx, vy = state[GX, i, m], state[GY, i, m], state[VX, i, m], state[VY, i, m]
        ux, uy = state[UX, i, m], state[UY, i, m]
        place = _zero(state[own, i, m]) + _zero(state[own + 1, i, m])
        place += _zero(state[frame, i, m]) + _zero(state[frame + 1, i, m])
        finite = place + _zero(gx) + _zero(gy) + _zero(vx) + _zero(vy) == 0.0
        share = within_wheels(vx, vy, gx, gy, constants.speed_limits[i], constants.turn_weights[i])
        dx, dy = ux - vx - share * gx, uy - vy - share * gy
        state[INTERVENTION, i, m] = math.sqrt(dx * dx + dy * dy) if finite else np.nan
        state[UX, i, m], state[UY, i, m] = (ux, uy) if finite else (np.nan, np.nan)
        dx, dy = wish_x[m] - vx, wish_y[m] - vy
        wish = math.sqrt(dx * dx + dy * dy)
        dx, dy = ux - vx, uy - vy
        progress = math.sqrt(dx * dx + dy * dy)
        stuck, side = state[STUCK, i, m], state[SIDE, i, m]
        longer, shorter = stuck + period, max(0.0, stuck - constants.stuck_recovery * period)
        waits = (progress < constants.stuck_progress * wish) & (wish > constants.stuck_wish)
        nowhere = longer >= constants.stuck_limit  # this side leads nowhere
        after = (constants.stuck_time if nowhere else longer) if waits else shorter
        turned = (-side if nowhere else side) if waits else (1.0 if shorter == 0.0 else side)
        state[STUCK, i, m] = after if finite else stuck
        state[SIDE, i, m] = turned if finite else side


@inlined
def _zero(x: float) -> float:
    """0 for a number, NaN for what is none."""
    return x - x
