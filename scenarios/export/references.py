"""References that change all the time, as a script computes them: what agents are told at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from formation import Phase
from formation.references.curves import ClosedCurve
from formation.references.ramps import Ramps
from formation.references.way_points import WayPoints
from scenarios.definition.experiment import Experiment
from scenarios.definition.schema import RampTable
from scenarios.errors import InputError
from scenarios.export.wording import number, table


def reference_text(experiment: Experiment, phase: Phase) -> tuple[str, str]:
    """Constants, and the function ``told``, of a phase with a reference.

    Raises:
        InputError: it is a function of the user's own.
    """
    reference, path = phase.reference, experiment.file.path
    delta = "" if phase.displacement is None else f"DELTA = {number(phase.displacement)}  # m, when it begins\n"
    if isinstance(reference, ClosedCurve):
        constants, function = _curve(reference)
        return f"\n{delta}{constants}", function
    if isinstance(reference, Ramps) and experiment.scenario.reference is not None:
        constants, function = _ramps(experiment.scenario.reference.velocities)
        return f"\n{delta}{constants}", TOLD + function
    if isinstance(reference, WayPoints) and experiment.scenario.reference is not None:
        return f"\n{delta}" + _way_points(experiment, reference), TOLD + BETWEEN_WAY_POINTS
    raise InputError(f"{path}: reference.function: a script for the testbed cannot carry it, expected none")


DECIMALS = 12
"""Of a way-point's numbers, metres and seconds: ends at rest are at rest."""

TOLD = '''

def told(t):
    """The velocity of all, and, of a formation that turns and scales, by what
    delta is multiplied and how fast that changes (1/s), t seconds on."""
'''

SHAPES = {
    "figure-eight": (
        "A * np.cos(phi) + 2j * B * np.cos(2 * phi)",
        "-A * np.sin(phi) - 4j * B * np.sin(2 * phi)",
    ),
}
ROUND = ("A * np.cos(phi) + 1j * B * np.sin(phi)", "-A * np.sin(phi) + 1j * B * np.cos(phi)")

CURVE = """\
A, B = {a}, {b}  # m, half the width and the height of the path
PACE = 2 * np.pi / {period}  # rad/s
AIM = {aim}  # the direction of the path's width
BEGIN = {begin}  # the tangent at the begin
"""

ON_CURVE = """\
    phi = PACE * t
    tangent = {tangent}
    bend = {bend}
"""

TURNING = """\
    factor = tangent / BEGIN
    factor /= abs(factor)
    rate = 1j * PACE * (bend / tangent).imag
    return PACE * AIM * tangent, factor, rate
"""

RAMPS = """\
# Time (s) and the velocity of all then; straight lines in between.
RAMPS = [
{rows}
]
TIMES, VELOCITIES = np.array(RAMPS).T
"""

BETWEEN_RAMPS = "    return np.interp(t, TIMES.real, VELOCITIES), 1, 0\n"

CHANGING_RAMPS = """\
# Time (s), the velocity of all then, and the formation's scale and turn (rad);
# straight lines in between.
RAMPS = [
{rows}
]
TIMES, VELOCITIES, SCALES, TURNS = np.array(RAMPS).T
"""

BETWEEN_CHANGING_RAMPS = """\
    velocity, scale, turn = (
        np.interp(t, TIMES.real, each) for each in (VELOCITIES, SCALES, TURNS)
    )
    k = np.searchsorted(TIMES.real, t + PERIOD / 2)  # where lines meet, the next
    rate = 0
    if k < len(TIMES):
        length = TIMES[k] - TIMES[k - 1]
        rate = (SCALES[k] - SCALES[k - 1]) / length / scale
        rate += 1j * (TURNS[k] - TURNS[k - 1]) / length
    return velocity, scale * np.exp(1j * turn), rate
"""

WAY = """\
# Time (s), place (m) and velocity (m/s) of agent {leader}, logarithm of what
# delta is multiplied by, and its rate (1/s); cubic in between.
WAY = [
{rows}
]
TIMES, *NODES = np.array(WAY).T
"""

BETWEEN_WAY_POINTS = """\
    k = np.searchsorted(TIMES.real, t, side="right")
    if k == len(TIMES):
        return 0, np.exp(NODES[2][-1]), 0
    length = (TIMES[k] - TIMES[k - 1]).real
    s = (t - TIMES[k - 1].real) / length

    def slope(value, rate):
        return (
            6 * s * (1 - s) * (value[k] - value[k - 1]) / length
            + (1 - s) * (1 - 3 * s) * rate[k - 1]
            + s * (3 * s - 2) * rate[k]
        )

    place, velocity, log, rate = NODES
    before = (1 + 2 * s) * log[k - 1] + s * length * rate[k - 1]
    after = (3 - 2 * s) * log[k] - (1 - s) * length * rate[k]
    factor = np.exp((1 - s) ** 2 * before + s**2 * after)
    return slope(place, velocity), factor, slope(log, rate)
"""


def _curve(curve: ClosedCurve) -> tuple[str, str]:
    half = complex(*curve.size) / 2.0
    tangent, bend = SHAPES.get(curve.shape, ROUND)
    if curve.clockwise:
        tangent, bend = f"({tangent}).conjugate()", f"({bend}).conjugate()"
    aim = complex(np.exp(1j * curve.direction))
    begin = complex(curve.velocity(0.0)) / aim / curve.angular_rate
    constants = CURVE.format(a=half.real, b=half.imag, period=curve.period, aim=number(aim), begin=number(begin))
    function = ON_CURVE.format(tangent=tangent, bend=bend)
    if curve.turning:
        return constants, TOLD + function + TURNING
    constants, function = constants[: constants.index("BEGIN")], function[: function.index("    bend")]
    return constants, TOLD + function + "    return PACE * AIM * tangent, 1, 0\n"


def _ramps(listed: Sequence[RampTable]) -> tuple[str, str]:
    first = listed[0]
    rows = [(repr(each.t_s), number(complex(*each.velocity_m_s))) for each in listed]
    ratios = [each.scale / first.scale for each in listed]
    turns = [float(np.radians(each.turn_deg - first.turn_deg)) for each in listed]
    if set(ratios) == {1.0} and set(turns) == {0.0}:
        return RAMPS.format(rows=table(rows)), BETWEEN_RAMPS
    whole = [(*row, repr(ratio), repr(turn)) for row, ratio, turn in zip(rows, ratios, turns, strict=True)]
    return CHANGING_RAMPS.format(rows=table(whole)), BETWEEN_CHANGING_RAMPS


def _way_points(experiment: Experiment, reference: WayPoints) -> str:
    points = experiment.scenario.reference.points if experiment.scenario.reference is not None else ()
    first, rows = points[0], []
    for point in points:
        last = point is points[-1]
        t = float(np.nextafter(point.t_s, 0.0)) if last else point.t_s  # where it ends, it has stopped
        factor = complex(np.log(point.scale / first.scale), np.radians(point.turn_deg - first.turn_deg))
        values = [
            complex(reference.path(point.t_s)),
            complex(reference.velocity(t)),
            factor,
            complex(reference.rate(t)),
        ]
        rows.append([repr(point.t_s), *(number(complex(np.round(value, DECIMALS))) for value in values)])
    return WAY.format(leader=experiment.number(0), rows=table(rows))
