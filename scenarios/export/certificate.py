"""The safety of a script: the testbed's own certificate, or the same with rows for obstacles, which it has not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.safety.certificate import (
    BARRIER_GAIN,
    BOUNDARY_MARGIN,
    BOUNDARY_SHARE,
    MAGNITUDE_LIMIT,
    SAFETY_RADIUS,
)
from scenarios.definition.experiment import Experiment
from scenarios.export.wording import number


@dataclass(frozen=True)
class SafetyText:
    """The safety of a script.

    Attributes:
        imported: the import of what ``rps`` gives.
        constants: of the module.
        functions: of the module.
        made: lines of ``main`` before the loop.
        used: lines in the loop, which change ``u``.
    """

    imported: str = ""
    constants: str = ""
    functions: str = ""
    made: str = ""
    used: str = ""


def safety_text(experiment: Experiment) -> SafetyText:
    """Nothing without a filter; any filter becomes the testbed's certificate."""
    name = experiment.scenario.safety.filter
    if name == "none":
        return SafetyText()
    # In the place of another filter it also keeps robots on the floor, beyond which its own default boundary lies.
    arena, substitute = experiment.arena, name != "robotarium"
    margin = 0.0 if substitute else BOUNDARY_MARGIN
    sides = [round(x + side * margin, 9) for x, side in zip((*arena.x, *arena.y), (-1, 1, -1, 1), strict=True)]
    why = f"In place of the scenario's {name} filter" if substitute else "As in the scenario"
    if not arena.obstacles:
        made = MADE.format(why=why, radius=SAFETY_RADIUS, gain=BARRIER_GAIN, boundary=sides)
        return SafetyText(IMPORT, made=made, used=USED)
    return SafetyText(
        OWN_IMPORT,
        OBSTACLES.format(
            obstacles="\n".join(_obstacle(each.vertices, each.radius) for each in arena.obstacles),
            clearance=experiment.scenario.safety.clearance_m,
            approach=experiment.scenario.safety.gain_per_s,
            radius=SAFETY_RADIUS,
            gain=BARRIER_GAIN,
            boundary=sides,
            limit=MAGNITUDE_LIMIT,
        ),
        OWN.format(share=BOUNDARY_SHARE),
        used="            u = certificate(u, p)\n",
    )


def _obstacle(vertices: np.ndarray, radius: float) -> str:
    corners = [number(complex(x, y)) for x, y in vertices.tolist()]
    line = f"    ([{', '.join(corners)}], {radius!r}),"
    if len(line) <= 79:
        return line
    return "\n".join(["    (", "        [", *(f"            {each}," for each in corners), "        ],"]) + (
        f"\n        {radius!r},\n    ),"
    )


IMPORT = """\
from rps.utilities.barrier_certificates import (
    create_si_barrier_certificate_with_boundary,
)
"""

MADE = """\
    # {why}.
    certificate = create_si_barrier_certificate_with_boundary(
        safety_radius={radius},  # m, between two steered points
        barrier_gain={gain},
        boundary_points=np.array({boundary}),
    )
"""

USED = """\
            wish, points = (np.array([z.real, z.imag]) for z in (u, p))
            vx, vy = certificate(wish, points)
            u = vx + 1j * vy
"""

OWN_IMPORT = "from rps.utilities.barrier_certificates import _solve_qp\n"

OBSTACLES = """
# Obstacles: the corners of each (m), and how far it reaches around them (m).
OBSTACLES = [
{obstacles}
]
CLEARANCE = {clearance}  # m, between a steered point and an obstacle
APPROACH = {approach}  # 1/s
RADIUS = {radius}  # m, between two steered points
BARRIER_GAIN = {gain}
X_LOW, X_HIGH, Y_LOW, Y_HIGH = {boundary}  # m
SPEED = {limit} * np.cos(np.pi / 8)  # m/s
"""

OWN = '''

def away(p, corners):
    """The shortest way from an obstacle's corners and sides to the point p."""
    ends = np.roll(corners, -1)
    sides, ways = ends - corners, p - np.array(corners)
    squared = np.maximum(abs(sides) ** 2, 1e-12)
    along = np.clip((ways * sides.conj()).real / squared, 0, 1)
    ways -= along * sides
    return ways[abs(ways).argmin()]


def certificate(u, p):
    """The velocities nearest to u with which the points p keep away from each
    other, from the floor's sides, as the testbed's own certificate has them,
    and from obstacles."""
    rows, bounds = [], []

    def limit(bound, *parts):
        """The velocities of agents along directions add up to this at most."""
        row = np.zeros((N, 2))
        for agent, direction in parts:
            row[agent] = direction.real, direction.imag
        rows.append(row.ravel())
        bounds.append(bound)

    for i in range(N):
        for j in range(i + 1, N):
            e = p[i] - p[j]
            h = abs(e) ** 2 - RADIUS**2
            limit(BARRIER_GAIN * h**3, (i, -2 * e), (j, 2 * e))
        for corners, radius in OBSTACLES:
            e = away(p[i], corners)
            room = abs(e) - radius - CLEARANCE
            limit(APPROACH * room, (i, -e / abs(e)))
        for outward, gap in (
            (1, X_HIGH - p[i].real),
            (-1, p[i].real - X_LOW),
            (1j, Y_HIGH - p[i].imag),
            (-1j, p[i].imag - Y_LOW),
        ):
            limit({share} * BARRIER_GAIN * (gap - RADIUS / 2) ** 3, (i, outward))
        for k in range(8):
            limit(SPEED, (i, np.exp(0.25j * np.pi * k)))
    wish = np.array([u.real, u.imag])
    safe = _solve_qp(N, wish, np.array(rows), np.array(bounds))
    return np.zeros(N) if safe is None else safe[0] + 1j * safe[1]
'''
