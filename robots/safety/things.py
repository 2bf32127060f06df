"""The nearest point of a wall or an obstacle, compiled; :class:`robots.obstacles.Obstacle` is the same in numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled

Real = NDArray[np.float64]


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
