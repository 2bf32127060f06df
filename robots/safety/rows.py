"""The rows of a robot's problem, compiled: what it senses of robots, walls and obstacles, run beside run.

:mod:`robots.safety.barrier` derives them. A row (n_x, n_y, b) is the half-plane n.u >= b, in the body frame of its
robot; what is not sensed has the row (0, 0, -inf), which nothing breaks. Nothing is solved here.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.arena import Arena
from robots.compiled import compiled, inlined
from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism
from robots.obstacles import pack
from robots.safety.barrier import (
    STUCK_PROGRESS,
    STUCK_RECOVERY,
    STUCK_TURN_LIMIT,
    STUCK_TURN_RATE,
    STUCK_WISH,
    WHEEL_MARGIN,
    FilterSettings,
    stuck_limit,
    turn_weight,
)
from robots.safety.protocol import WALLS
from robots.safety.things import nearest_on_obstacle
from robots.senses.chance import pair
from robots.senses.noise import Noise
from robots.worlds.lanes import VX, VY, Senses

Real = NDArray[np.float64]
Index = NDArray[np.int64]

MOST = 1e6
"""m/s: no wish and no row counts for more, so that all sums and quotients of them are finite."""

COINCIDENT = 1e-150
"""Metres up to which two robots are in one place: no direction leads away, and their squared distance is 0."""

NORMAL_X, NORMAL_Y, LEVEL, CLOSE = range(4)
"""Of a row, along the second axis of an array (m, 4, L): n, b (m/s), and how close the thing is, 0 at the edge of what
is sensed, 1 at the distance that is kept."""
ROW = 4


class Constants(NamedTuple):
    """What does not change during a run; lengths in metres, speeds in m/s, times in seconds, angles in radians."""

    safe_distance: float
    sensing_range: float
    clearance: float
    gain: float
    turn: float
    stuck_time: float
    stuck_limit: float
    stuck_progress: float
    stuck_wish: float
    stuck_recovery: float
    stuck_turn_rate: float
    stuck_turn_limit: float
    speed_limits: Real
    turn_weights: Real


class Things(NamedTuple):
    """What stands still.

    Attributes:
        walls: (4, 3) or (0, 3) rows (n_x, n_y, c): inside is n.p >= c.
        vertices, first_vertex, radii: (V, 2), (O + 1,), (O,) convex cores of the obstacles and what is around them.
    """

    walls: Real
    vertices: Real
    first_vertex: Index
    radii: Real


def constants(settings: FilterSettings, drive: DifferentialDrive, nid: NearIdentityDiffeomorphism, n: int) -> Constants:
    """What the compiled filter has to know of its settings and of the n robots."""
    return Constants(
        safe_distance=float(settings.safe_distance),
        sensing_range=float(settings.sensing_range),
        clearance=float(settings.clearance),
        gain=float(settings.gain),
        turn=float(settings.turn),
        stuck_time=float(settings.stuck_time),
        stuck_limit=stuck_limit(settings),
        stuck_progress=STUCK_PROGRESS,
        stuck_wish=STUCK_WISH,
        stuck_recovery=STUCK_RECOVERY,
        stuck_turn_rate=STUCK_TURN_RATE,
        stuck_turn_limit=STUCK_TURN_LIMIT,
        speed_limits=np.array(np.broadcast_to(drive.speed_limit, n)) * (1.0 - WHEEL_MARGIN),
        turn_weights=np.array(np.broadcast_to(turn_weight(drive, nid), n)),
    )


def things(arena: Arena | None) -> Things:
    """What stands still in an arena; nothing on an endless floor."""
    walls = np.empty((0, 3)) if arena is None else arena.wall_planes
    return Things(walls, *pack(() if arena is None else arena.obstacles))


@compiled
def rows_of(
    state: Real,
    i: int,
    found: Index,
    count: int,
    senses: Senses,
    constants: Constants,
    things: Things,
    noise: Noise,
    rows: Real,
    source: Index,
) -> int:
    """Write the rows of robot i: of the ``count`` robots ``found``, then of walls and obstacles; their number.

    Args:
        rows: (m, 4, L) out.
        source: (m,) out: what each belongs to: robots 0..n-1, walls n..n+3, then obstacles.
    """
    n, noisy = state.shape[1], noise.position > 0.0 or noise.bearing > 0.0
    reach, safe = constants.sensing_range, constants.safe_distance
    for place in range(count):
        j = found[place]
        source[place] = j
        _toward(state, i, j, senses, reach * reach, rows[place])
        if noisy:
            _disturb(i, j, noise, rows[place])
        _robot_row(state[VX, i], state[VY, i], rows[place], safe, reach - safe, constants.gain)
    walls = len(things.walls)
    for k in range(walls + len(things.radii)):
        place = count + k
        source[place] = n + (k if k < walls else WALLS + k - walls)
        _away(state, i, k, senses, things, constants.clearance + reach - safe, rows[place])
        if noisy:
            _disturb(i, source[place], noise, rows[place])
        _thing_row(rows[place], constants.clearance, reach - safe, constants.gain)
    return count + walls + len(things.radii)


@inlined
def _toward(state: Real, i: int, j: int, senses: Senses, reach2: float, row: Real) -> None:
    """The vector from robot j to robot i, metres, in the frame of i, as n; b is 0, or -inf where j is not sensed."""
    own, frame, other = senses
    for m in range(row.shape[1]):
        dx, dy = state[own, i, m] - state[other, j, m], state[own + 1, i, m] - state[other + 1, j, m]
        c, s = state[frame, i, m], state[frame + 1, i, m]
        row[NORMAL_X, m], row[NORMAL_Y, m] = c * dx + s * dy, c * dy - s * dx
        row[LEVEL, m] = 0.0 if dx * dx + dy * dy < reach2 else -np.inf


@inlined
def _away(state: Real, i: int, k: int, senses: Senses, things: Things, reach: float, row: Real) -> None:
    """The vector from the nearest point of thing k to robot i, as n; b is the sign of the distance, or -inf.

    On the thing itself the vector has no length; n is then the direction away from it, and b is 0.
    """
    own, frame, _ = senses
    walls = len(things.walls)
    for m in range(row.shape[1]):
        x, y = state[own, i, m], state[own + 1, i, m]
        if k < walls:
            ox, oy = things.walls[k, 0], things.walls[k, 1]
            distance = ox * x + oy * y - things.walls[k, 2]
        else:
            o = k - walls
            core = things.vertices[things.first_vertex[o] : things.first_vertex[o + 1]]
            distance, ox, oy = nearest_on_obstacle(core, x, y)
            distance -= things.radii[o]
        c, s = state[frame, i, m], state[frame + 1, i, m]
        nx, ny = c * ox + s * oy, c * oy - s * ox
        size = distance if distance != 0.0 else 1.0
        row[NORMAL_X, m], row[NORMAL_Y, m] = size * nx, size * ny
        sign = 0.0 if distance == 0.0 else math.copysign(1.0, distance)
        row[LEVEL, m] = sign if distance < reach else -np.inf


@inlined
def _disturb(i: int, code: int, noise: Noise, row: Real) -> None:
    """Turn and shift the vectors from a thing to its observer, whose measurement is of the opposite vector."""
    for m in range(row.shape[1]):
        if row[LEVEL, m] > -np.inf:  # what is not sensed draws nothing
            cosine, sine, x, y = pair(noise.keys[m], i, code, noise.position, noise.bearing)
            ex, ey = row[NORMAL_X, m], row[NORMAL_Y, m]
            row[NORMAL_X, m], row[NORMAL_Y, m] = cosine * ex - sine * ey - x, sine * ex + cosine * ey - y


@inlined
def _robot_row(vx: Real, vy: Real, row: Real, safe: float, window: float, gain: float) -> None:
    """The row (pair) from the vector in the place of n; a robot in one place with this one has none."""
    quarter, safe2, reach, share = gain / 4.0, safe * safe, safe + window, 1.0 / window
    for m in range(row.shape[1]):
        ex, ey = row[NORMAL_X, m], row[NORMAL_Y, m]
        distance = math.sqrt(ex * ex + ey * ey)
        sensed = (row[LEVEL, m] == 0.0) & (distance > COINCIDENT)
        inverse = 1.0 / distance
        nx, ny = ex * inverse, ey * inverse
        barrier = quarter * (distance - safe2 * inverse)
        level = nx * vx[m] + ny * vy[m] - max(barrier, -MOST)
        row[NORMAL_X, m], row[NORMAL_Y, m] = nx if sensed else 0.0, ny if sensed else 0.0
        row[LEVEL, m] = level if sensed else -np.inf
        row[CLOSE, m] = min(max((reach - distance) * share, 0.0), 1.0) if sensed else 0.0


@inlined
def _thing_row(row: Real, clearance: float, window: float, gain: float) -> None:
    """The row (thing) from the vector in the place of n and the sign of the distance in the place of b."""
    for m in range(row.shape[1]):
        ex, ey, sign = row[NORMAL_X, m], row[NORMAL_Y, m], row[LEVEL, m]
        sensed = sign >= -1.0
        length = math.sqrt(ex * ex + ey * ey)
        size = (-length if sign < 0.0 else length) if length > 0.0 else 1.0
        distance = size if (sign != 0.0) & (length > 0.0) else 0.0
        row[NORMAL_X, m], row[NORMAL_Y, m] = ex / size if sensed else 0.0, ey / size if sensed else 0.0
        row[LEVEL, m] = -max(gain * (distance - clearance), -MOST) if sensed else -np.inf
        row[CLOSE, m] = min(max(1.0 - (distance - clearance) / window, 0.0), 1.0) if sensed else 0.0
