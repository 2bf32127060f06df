"""One step of the decentralised filter for all robots of all runs, compiled.

Everything that numba compiles is in this one file: its cache looks at the time stamp of the file that holds the
function that is called, so a callee elsewhere could leave stale machine code behind. Three ideas, from the inside out:
the exact two-variable solver, the neighbour search on a grid of cells, and the step itself.
:mod:`robots.safety.barrier` derives the rows.

A row (a_x, a_y, b) of the arrays below is the half-plane a.u >= b with |a| = 1. The first :data:`WHEEL_ROWS` rows are
hard: the sides of the wheels' diamond.
"""

# Longer than 300 lines: what numba compiles together has to stand in one file, see above.

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled
from robots.safety.protocol import BLOCKERS, WALLS

Real = NDArray[np.float64]
Index = NDArray[np.int64]
Count = int | np.int64

WHEEL_ROWS = 4
"""The diamond |u_x| + r |u_y| <= L has four sides."""

_PARALLEL = 1e-12  # sine of the angle between two rows that are taken as parallel
_TIGHT = 1e-12  # m/s by which rounding may break a row
_RELAXED = 1e-9  # m/s below which a relaxation is rounding
_MOST = 1e6  # m/s: no wish and no row counts for more, so that all sums and quotients of them are finite


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


@compiled
def _interval(rows: Real, count: Count, px: float, py: float, tx: float, ty: float) -> tuple[float, float, bool]:
    """The part [low, high] of the line p + s t that satisfies the first ``count`` rows, and whether there is one."""
    low, high = -np.inf, np.inf
    for j in range(count):
        slope = rows[j, 0] * tx + rows[j, 1] * ty
        gap = rows[j, 2] - rows[j, 0] * px - rows[j, 1] * py
        if abs(slope) <= _PARALLEL:
            if gap > _TIGHT:
                return 0.0, 0.0, False
        elif slope > 0.0:
            low = max(low, gap / slope)
        else:
            high = min(high, gap / slope)
    if low > high:
        if low - high > _TIGHT:
            return 0.0, 0.0, False
        low = high = 0.5 * (low + high)  # three rows through one point, up to rounding
    return low, high, True


@compiled
def _nearest(rows: Real, count: Count, x0: float, y0: float) -> tuple[float, float, bool]:
    """The point nearest to (x0, y0) that satisfies the first ``count`` rows, and whether there is one.

    Incremental (Seidel 1991): while a row holds at the optimum of the rows before it nothing changes; when it does not,
    the new optimum lies on its line, and the rows before it leave an interval of that line.
    """
    x, y = x0, y0
    for i in range(count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if ax * x + ay * y >= b - _TIGHT:
            continue
        to_line = b - ax * x0 - ay * y0
        px, py = x0 + to_line * ax, y0 + to_line * ay
        low, high, found = _interval(rows, i, px, py, -ay, ax)
        if not found:
            return x, y, False
        s = min(max(0.0, low), high)
        x, y = px - s * ay, py + s * ax
    return x, y, True


@compiled
def _farthest(rows: Real, count: Count, cx: float, cy: float, x: float, y: float) -> tuple[float, float]:
    """The point farthest along c that satisfies the first ``count`` rows, given the one (x, y) of the wheel rows."""
    for i in range(WHEEL_ROWS, count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if ax * x + ay * y >= b - _TIGHT:
            continue
        to_line = b - ax * x - ay * y
        px, py = x + to_line * ax, y + to_line * ay
        low, high, found = _interval(rows, i, px, py, -ay, ax)
        if not found:  # only rounding can get here: the caller's rows have a common point
            continue
        along = cy * ax - cx * ay
        s = high if along > 0.0 else low
        x, y = px - s * ay, py + s * ax
    return x, y


@compiled
def _least_relaxation(
    rows: Real, count: Count, work: Real, speed: float, weight: float, x: float, y: float
) -> tuple[float, float, float]:
    """The point within the wheels' diamond that breaks the other rows least, and by how much, m/s.

    Incremental in the three variables u and delta, rows a.u >= b - delta: when a row is broken at (u, delta), the new
    optimum has delta = b - a.u, which leaves a linear programme in u.

    Args:
        rows: the rows, wheel rows first.
        count: how many there are.
        work: scratch of the shape of ``rows``.
        speed, weight: L and r of the diamond.
        x, y: a point of the diamond.
    """
    delta = 0.0
    work[:WHEEL_ROWS] = rows[:WHEEL_ROWS]
    for i in range(WHEEL_ROWS, count):
        ax, ay, b = rows[i, 0], rows[i, 1], rows[i, 2]
        if b - ax * x - ay * y <= delta + _TIGHT:
            continue
        used = np.int64(WHEEL_ROWS)
        for j in range(WHEEL_ROWS, i):
            dx, dy = rows[j, 0] - ax, rows[j, 1] - ay
            length = np.hypot(dx, dy)
            if length > _PARALLEL:  # of two parallel rows the later one is the stricter, it is broken
                work[used, 0], work[used, 1], work[used, 2] = dx / length, dy / length, (rows[j, 2] - b) / length
                used += 1
        if abs(ax) * weight >= abs(ay):
            corner_x, corner_y = np.copysign(speed, ax), 0.0
        else:
            corner_x, corner_y = 0.0, np.copysign(speed / weight, ay)
        x, y = _farthest(work, used, ax, ay, corner_x, corner_y)
        delta = max(delta, b - ax * x - ay * y)
    return x, y, delta


@compiled
def wheel_rows(rows: Real, speed: float, weight: float) -> None:
    """Write the sides of the diamond |u_x| + weight |u_y| <= speed into the first rows."""
    norm = np.hypot(1.0, weight)
    for side in range(WHEEL_ROWS):
        rows[side, 0] = (1.0 if side % 2 else -1.0) / norm
        rows[side, 1] = (weight if side // 2 else -weight) / norm
        rows[side, 2] = -speed / norm


@compiled
def project(
    rows: Real, count: Count, work: Real, speed: float, weight: float, x0: float, y0: float
) -> tuple[float, float, float]:
    """The point nearest to (x0, y0) that satisfies the rows; the least relaxation if none does.

    Args:
        rows: (m, 3) unit rows, the first of them from :func:`wheel_rows`. Where no point satisfies all, the thresholds
            of all others are lowered by the relaxation.
        count: how many rows there are.
        work: scratch of the shape of ``rows``.
        speed, weight: L in m/s and r of the diamond.
        x0, y0: the point wished for, m/s.

    Returns:
        The point, m/s, and the relaxation: 0, or the least by which all rows but the wheels' are to be lowered, m/s.
    """
    x, y, found = _nearest(rows, count, x0, y0)
    if found:
        return x, y, 0.0
    x, y, _ = _nearest(rows, np.int64(WHEEL_ROWS), x0, y0)
    x, y, delta = _least_relaxation(rows, count, work, speed, weight, x, y)
    for i in range(WHEEL_ROWS, count):
        rows[i, 2] -= delta
    nearer_x, nearer_y, found = _nearest(rows, count, x0, y0)
    if found:
        x, y = nearer_x, nearer_y
    return x, y, delta if delta > _RELAXED else 0.0


@compiled
def _finite(x: float, y: float) -> bool:
    return np.isfinite(x) and np.isfinite(y)


@compiled
def _bucket(cx: int, cy: int, size: int) -> int:
    return ((cx * 73856093) ^ (cy * 19349663)) & (size - 1)


@compiled
def _cell(coordinate: float, side: float) -> int:
    return int(np.floor(min(max(coordinate / side, -1e9), 1e9)))


@compiled
def _fill_grid(points: Real, side: float, cells: Index, first: Index, order: Index) -> None:
    """Sort robots into cells of a side, metres, hashed into buckets: ``order[first[b]:first[b + 1]]`` is bucket b.

    Hashing keeps the grid as small as the crowd, however far a robot strays. A robot without a finite position is in
    no bucket: nobody can sense it.
    """
    size = len(first) - 1
    first[:] = 0
    for i in range(len(points)):
        cells[i, 2] = -1
        if _finite(points[i, 0], points[i, 1]):
            for axis in range(2):
                cells[i, axis] = _cell(points[i, axis], side)
            cells[i, 2] = _bucket(cells[i, 0], cells[i, 1], size)
            first[cells[i, 2]] += 1
    for b in range(size):
        first[b + 1] += first[b]
    for i in range(len(points) - 1, -1, -1):
        b = cells[i, 2]
        if b >= 0:
            first[b] -= 1  # from the end of the bucket down to its start
            order[first[b]] = i


@compiled
def nearest_on_obstacle(vertices: Real, x: float, y: float) -> tuple[float, float, float]:
    """Signed distance, metres, from a convex core to (x, y), and the unit vector from the core to the point.

    The core is a point, a segment, or a polygon with its vertices counter-clockwise; inside a polygon the distance is
    negative.
    """
    count = len(vertices)
    best, bx, by = np.inf, 0.0, 0.0
    inside = count > 2
    depth, ox, oy = -np.inf, 0.0, 0.0
    edges = count if count > 2 else 1
    for k in range(edges):
        ax, ay = vertices[k, 0], vertices[k, 1]
        after = (k + 1) % count
        ex, ey = vertices[after, 0] - ax, vertices[after, 1] - ay
        dx, dy = x - ax, y - ay
        length2 = ex * ex + ey * ey
        s = min(max((dx * ex + dy * ey) / length2, 0.0), 1.0) if length2 > 0.0 else 0.0
        qx, qy = dx - s * ex, dy - s * ey
        distance2 = qx * qx + qy * qy
        if distance2 < best:
            best, bx, by = distance2, qx, qy
        if count > 2:
            length = np.sqrt(length2)
            outward = (ey * dx - ex * dy) / length
            if not outward <= 0.0:  # also where a point is so far off that its products overflow
                inside = False
            if outward > depth:
                depth, ox, oy = outward, ey / length, -ex / length
    if inside:
        return depth, ox, oy
    distance = np.sqrt(best)
    if distance == 0.0:
        return 0.0, ox, oy
    return distance, bx / distance, by / distance


@compiled
def _within_wheels(vx: float, vy: float, gx: float, gy: float, speed: float, weight: float) -> float:
    """The largest s <= 1 with v + s g in the wheels' diamond; 0 if v itself is not and g does not lead back."""
    s = 1.0
    for side in range(WHEEL_ROWS):
        sign_x = 1.0 if side % 2 else -1.0
        sign_y = weight if side // 2 else -weight
        room = speed - sign_x * vx - sign_y * vy
        slope = sign_x * gx + sign_y * gy
        if slope > room:
            s = min(s, room / slope) if room > 0.0 else 0.0
    return s


@compiled
def _bounded(x: float, y: float) -> tuple[float, float]:
    """(x, y), m/s, shortened to :data:`_MOST` in its larger part."""
    largest = max(abs(x), abs(y))
    if largest <= _MOST:
        return x, y
    return x / largest * _MOST, y / largest * _MOST


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
    work, source = np.empty_like(rows), np.empty(len(rows), np.int64)
    reach, safe, gain = constants.sensing_range, constants.safe_distance, constants.gain
    window = reach - safe
    noisy = turns.shape[2] > 0
    for run in range(batch):
        p, q = points[run], seen[run]
        _fill_grid(q, reach, cells, first, order)
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
            column, line = _cell(x, reach), _cell(y, reach)
            for cell in range(9):
                cx, cy = column + cell % 3 - 1, line + cell // 3 - 1
                b = _bucket(cx, cy, size)
                for place in range(first[b], first[b + 1]):
                    j = order[place]
                    if j == i or cells[j, 0] != cx or cells[j, 1] != cy:
                        continue
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
                    rows[count, 2] = nx * vx + ny * vy - max(barrier, -_MOST)
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
                rows[count, 2] = -max(gain * (distance - constants.clearance), -_MOST)
                source[count] = code
                count += 1
                crowding = max(crowding, _crowding((distance - constants.clearance) / window, nx, ny, gx, gy, law))
            wait = max(0.0, stuck[run, i] - constants.stuck_time)
            phi = constants.turn * crowding + min(constants.stuck_turn_limit, constants.stuck_turn_rate * wait)
            c, s = np.cos(phi), side[run, i] * np.sin(phi)
            tx, ty = c * gx - s * gy, s * gx + c * gy
            s = _within_wheels(vx, vy, tx, ty, speed, weight)
            tx, ty = s * tx, s * ty
            ux, uy, delta = project(rows, count, work, speed, weight, vx + tx, vy + ty)
            u[run, i, 0], u[run, i, 1] = ux, uy
            relaxation[run, i] = delta
            if delta > 0.0:
                # The thresholds are lowered by now: the rows that decided are those without slack.
                found = 0
                for r in range(WHEEL_ROWS, count):
                    if found < BLOCKERS and rows[r, 0] * ux + rows[r, 1] * uy <= rows[r, 2] + _RELAXED:
                        blockers[run, i, found] = source[r]
                        found += 1
            s = _within_wheels(vx, vy, gx, gy, speed, weight)
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
