"""One step of the decentralised filter for all robots of all runs, compiled, robot by robot.

Whom a robot may sense, :mod:`robots.safety.crowd` finds. :mod:`robots.safety.barrier` derives the rows,
:mod:`robots.safety.solver` solves them; :mod:`robots.safety.step` is the same step with runs side by side, and a test
holds the two together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled
from robots.safety.crowd import around, fill_grid
from robots.safety.protocol import BLOCKERS, WALLS
from robots.safety.rows import MOST, Constants
from robots.safety.solver import RELAXED, WHEEL_ROWS, project, wheel_rows, within_wheels
from robots.safety.things import nearest_on_obstacle

Real = NDArray[np.float64]
Index = NDArray[np.int64]


@compiled
def _finite(x: float, y: float) -> bool:
    return np.isfinite(x) and np.isfinite(y)


@compiled
def _bounded(x: float, y: float) -> tuple[float, float]:
    """(x, y), m/s, shortened to :data:`MOST` in its larger part."""
    largest = max(abs(x), abs(y))
    if largest <= MOST:
        return x, y
    return x / largest * MOST, y / largest * MOST


@compiled
def step(
    points: Real,
    seen: Real,
    headings: Real,
    feedback: Real,
    common: Real,
    stuck: Real,
    side: Real,
    period: float,
    constants: Constants,
    walls: Real,
    vertices: Real,
    first_vertex: Index,
    radii: Real,
    turns: Real,
    offsets: Real,
    u: Real,
    intervention: Real,
    relaxation: Real,
    blockers: Index,
) -> None:
    """One control period of B runs with n robots each.

    Args:
        points, headings: (B, n, 2) projected points, metres, and unit heading vectors.
        seen: (B, n, 2) where the others sense each robot, metres; ``points`` again unless they sense it late.
        feedback, common: (B, n, 2) the law without v_r, and v_r, m/s, in body frames.
        stuck: (B, n) the state tau, seconds; advanced in place.
        side: (B, n) the side to which a robot turns, 1 left or -1 right; advanced in place.
        period: seconds.
        constants: of the filter and of the drive.
        walls: (4, 3) or (0, 3) rows (n_x, n_y, c): inside is n.p >= c.
        vertices, first_vertex, radii: (V, 2), (O + 1,), (O,) convex cores of the obstacles and what is around them.
        turns, offsets: (B, n, n + 4 + O, 2) noise of the measurement of every robot, wall and obstacle: a unit rotation
            and an offset, metres, in the observer's frame; or (B, n, 0, 2) for perfect sensors.
        u: (B, n, 2) out: the filtered velocities, m/s.
        intervention: (B, n) out: |u - (v_r + s g)|, m/s, how far that is from the law within the wheels' limits.
        relaxation: (B, n) out: of the robot's rows, m/s.
        blockers: (B, n, 3) out: what the rows of a relaxed problem belong to, robots 0..n-1, walls n..n+3, then
            obstacles; -1 where there is none.
    """
    batch, n = points.shape[0], points.shape[1]
    obstacles = len(radii)
    size = 1
    while size < 2 * n:
        size *= 2
    cells, order, first = np.empty((n, 3), np.int64), np.empty(n, np.int64), np.empty(size + 1, np.int64)
    rows = np.empty((WHEEL_ROWS + n + len(walls) + obstacles, 3))
    work, source, found = np.empty_like(rows), np.empty(len(rows), np.int64), np.empty(n, np.int64)
    reach, safe, gain = constants.sensing_range, constants.safe_distance, constants.gain
    window = reach - safe
    noisy = turns.shape[2] > 0
    for run in range(batch):
        p, q = points[run], seen[run]
        fill_grid(q[:, 0], q[:, 1], reach, cells, first, order)
        for i in range(n):
            x, y = p[i, 0], p[i, 1]
            hx, hy = headings[run, i, 0], headings[run, i, 1]
            gx, gy = feedback[run, i, 0], feedback[run, i, 1]
            vx, vy = common[run, i, 0], common[run, i, 1]
            blockers[run, i] = -1
            relaxation[run, i] = 0.0
            if not (_finite(x, y) and _finite(hx, hy) and _finite(gx, gy) and _finite(vx, vy)):
                u[run, i] = np.nan
                intervention[run, i] = np.nan
                continue
            gx, gy = _bounded(gx, gy)
            vx, vy = _bounded(vx, vy)
            speed, weight = constants.speed_limits[i], constants.turn_weights[i]
            wheel_rows(rows, speed, weight)
            count = np.int64(WHEEL_ROWS)  # a literal would be a type of its own, and compile all of it twice
            law = np.hypot(gx, gy)
            crowding = 0.0
            for place in range(around(x, y, reach, i, cells, first, order, found)):
                j = found[place]
                dx, dy = x - q[j, 0], y - q[j, 1]
                if dx * dx + dy * dy >= reach * reach:
                    continue
                ex, ey = hx * dx + hy * dy, hx * dy - hy * dx
                if noisy:
                    ex, ey = _measured(ex, ey, turns[run, i, j], offsets[run, i, j])
                distance = np.hypot(ex, ey)
                if distance == 0.0:  # no direction leads away
                    continue
                nx, ny = ex / distance, ey / distance
                rows[count, 0], rows[count, 1] = nx, ny
                barrier = gain * (distance * distance - safe * safe) / (4.0 * distance)
                rows[count, 2] = nx * vx + ny * vy - max(barrier, -MOST)
                source[count] = j
                count += 1
                crowding = max(crowding, _crowding((distance - safe) / window, nx, ny, gx, gy, law))
            for k in range(len(walls) + obstacles):
                if k < len(walls):
                    ox, oy = walls[k, 0], walls[k, 1]
                    distance = ox * x + oy * y - walls[k, 2]
                    code = n + k
                else:
                    o = k - len(walls)
                    distance, ox, oy = nearest_on_obstacle(vertices[first_vertex[o] : first_vertex[o + 1]], x, y)
                    distance -= radii[o]
                    code = n + WALLS + o
                if distance - constants.clearance >= window:
                    continue
                ex, ey = distance * (hx * ox + hy * oy), distance * (hx * oy - hy * ox)
                sign = 1.0 if distance >= 0.0 else -1.0
                if noisy:
                    ex, ey = _measured(ex, ey, turns[run, i, code], offsets[run, i, code])
                distance = sign * np.hypot(ex, ey)
                if distance == 0.0:
                    nx, ny = hx * ox + hy * oy, hx * oy - hy * ox
                else:
                    nx, ny = ex / distance, ey / distance
                rows[count, 0], rows[count, 1] = nx, ny
                rows[count, 2] = -max(gain * (distance - constants.clearance), -MOST)
                source[count] = code
                count += 1
                crowding = max(crowding, _crowding((distance - constants.clearance) / window, nx, ny, gx, gy, law))
            wait = max(0.0, stuck[run, i] - constants.stuck_time)
            phi = constants.turn * crowding + min(constants.stuck_turn_limit, constants.stuck_turn_rate * wait)
            c, s = np.cos(phi), side[run, i] * np.sin(phi)
            tx, ty = c * gx - s * gy, s * gx + c * gy
            s = within_wheels(vx, vy, tx, ty, speed, weight)
            tx, ty = s * tx, s * ty
            ux, uy, delta = project(rows, count, work, speed, weight, vx + tx, vy + ty)
            u[run, i, 0], u[run, i, 1] = ux, uy
            relaxation[run, i] = delta
            if delta > 0.0:
                # The thresholds are lowered by now: the rows that decided are those without slack.
                blocking = 0
                for r in range(WHEEL_ROWS, count):
                    if blocking < BLOCKERS and rows[r, 0] * ux + rows[r, 1] * uy <= rows[r, 2] + RELAXED:
                        blockers[run, i, blocking] = source[r]
                        blocking += 1
            s = within_wheels(vx, vy, gx, gy, speed, weight)
            intervention[run, i] = np.hypot(ux - vx - s * gx, uy - vy - s * gy)
            wish, progress = np.hypot(tx, ty), np.hypot(ux - vx, uy - vy)
            if progress < constants.stuck_progress * wish and wish > constants.stuck_wish:
                stuck[run, i] += period
                if stuck[run, i] >= constants.stuck_limit:  # this side leads nowhere
                    stuck[run, i] = constants.stuck_time
                    side[run, i] = -side[run, i]
            else:
                stuck[run, i] = max(0.0, stuck[run, i] - constants.stuck_recovery * period)
                if stuck[run, i] == 0.0:
                    side[run, i] = 1.0


@compiled
def _measured(ex: float, ey: float, turn: Real, offset: Real) -> tuple[float, float]:
    """What comes of the vector from a thing to its observer, whose measurement is of the opposite vector."""
    return turn[0] * ex - turn[1] * ey - offset[0], turn[1] * ex + turn[0] * ey - offset[1]


@compiled
def _crowding(gap: float, nx: float, ny: float, gx: float, gy: float, law: float) -> float:
    """How much the law drives at something near: 0 beyond the sensing range or driving away, 1 head-on at contact."""
    if law == 0.0:
        return 0.0
    return min(max(1.0 - gap, 0.0), 1.0) * max(0.0, -(nx * gx + ny * gy) / law)
