"""Robots of many runs as lanes of one array: the state, and the unicycle that advances it, compiled.

A state is an array (FIELDS, n, L): a quantity of robot i in run m stands at ``state[quantity, i, m]``. Runs lie beside
each other in memory, so that loops over them become vector instructions; one run is an array with L = 1 and goes
through the same instructions, bit for bit. Headings are unit vectors that are turned and kept at length 1, and sines
are polynomials: neither leaves the loop for a library.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, inlined
from robots.drive import DifferentialDrive, Saturation
from robots.nid import NearIdentityDiffeomorphism
from robots.worlds.protocol import NOTHING

Real = NDArray[np.float64]

X, Y, THETA, PX, PY, LEFT, RIGHT, INTERVENTION, RELAXATION, STUCK, WX, WY, UX, UY, CONTACT, ACTIVE = range(16)
"""What is recorded: pose of the axle (m, rad), projected point (m); of the last period the wheel speeds (rad/s), what
the safety filter says (m/s, m/s, s), in the body frame, m/s, the wish of law and v_r and the command, the row of whom
the robot touched, and 1 where it may move, 0 where it waits."""
RECORDED = 16
COS, SIN, SIDE, GX, GY, VX, VY, SEEN_X, SEEN_Y, SEEN_COS, SEEN_SIN, SETTLED = range(RECORDED, RECORDED + 12)
"""What else a state holds: heading; the filter's side; in the body frame, m/s, the law and v_r; where others see a
robot late, metres, and its heading then; and 1 where it has been in its place, 0 where not yet."""
FIELDS = RECORDED + 12


class Senses(NamedTuple):
    """Fields of the state that robots sense: each the x of a pair, y is the next one.

    Attributes:
        own: where a robot takes itself to be, metres.
        frame: the heading of the frame in which it measures.
        others: where it sees the others.
    """

    own: int
    frame: int
    others: int


NOW = Senses(PX, COS, PX)
"""What perfect sensors show."""

UNLIMITED, SCALE, CLIP = range(3)
_SATURATION = {"scale": SCALE, "clip": CLIP}


class Wheels(NamedTuple):
    """A drive and its NID map, for the compiled unicycle.

    Attributes:
        radius: of a wheel, metres.
        half_base: half the distance between the wheels, metres.
        limits: (n,) of either wheel's speed of each robot, rad/s.
        projections: (n,) l of each, metres.
        saturation: :data:`UNLIMITED`, :data:`SCALE` or :data:`CLIP`.
        room: (3, L) for the turns of one robot in all runs.
    """

    radius: float
    half_base: float
    limits: Real
    projections: Real
    saturation: int
    room: Real


def wheels(
    drive: DifferentialDrive, nid: NearIdentityDiffeomorphism, saturation: Saturation | None, n: int, runs: int
) -> Wheels:
    """The drives of n robots in so many runs for :func:`roll`; ``saturation`` None for wheels without limit."""
    mode = UNLIMITED if saturation is None else _SATURATION[saturation]
    limits, projections = (np.array(np.broadcast_to(a, n)) for a in (drive.wheel_speed_limit, nid.projection_distance))
    return Wheels(drive.wheel_radius, drive.base_length / 2.0, limits, projections, mode, np.empty((3, runs)))


def at_rest(n: int, runs: int) -> Real:
    """The state (FIELDS, n, L) of n robots in so many runs, all at the origin."""
    state = np.zeros((FIELDS, n, runs))
    state[COS] = state[SIDE] = state[ACTIVE] = 1.0
    state[CONTACT] = NOTHING
    return state


def new_state(poses: Real, ahead: float | Real) -> Real:
    """The state of runs at rest at the poses (L, n, 3), projected points ``ahead`` of them, metres, (n, 1) of each."""
    state = at_rest(poses.shape[1], poses.shape[0])
    state[[X, Y, THETA]] = np.moveaxis(poses, (0, 1, 2), (2, 1, 0))
    state[COS], state[SIN] = np.cos(state[THETA]), np.sin(state[THETA])
    state[PX] = state[X] + ahead * state[COS]
    state[PY] = state[Y] + ahead * state[SIN]
    return state


WITHIN = 0.785
"""Radians, an eighth of a turn."""


@inlined
def sine_cosine_within(r: float) -> tuple[float, float]:
    """Those of :func:`sine_cosine`, bit for bit, of an angle up to :data:`WITHIN`, radians."""
    z = r * r
    tail = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    tail = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * tail)
    sine = r + r * z * (-1.66666666666666324348e-01 + z * tail)
    tail = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    tail = -1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * tail)
    cosine = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * tail)
    return sine, cosine


@inlined
def sine_cosine(angle: float) -> tuple[float, float]:
    """Sine and cosine of an angle, radians, within 2 units in the last place up to 1e5.

    The angle is reduced by quarter turns in three parts (Cody, Waite); polynomials of fdlibm's degree do the rest.
    """
    quarters = math.floor(angle * 0.6366197723675814 + 0.5)
    r = angle - quarters * 1.57079632673412561417e00
    r = (r - quarters * 6.07710050630396597660e-11) - quarters * 2.02226624879595063154e-21
    sine, cosine = sine_cosine_within(r)
    quadrant = quarters - 4.0 * math.floor(quarters * 0.25)
    odd = (quadrant == 1.0) | (quadrant == 3.0)
    one, other = (cosine, sine) if odd else (sine, cosine)
    one = -one if quadrant >= 2.0 else one
    other = -other if (quadrant == 1.0) | (quadrant == 2.0) else other
    return one, other


@inlined
def wheel_speeds(ux: float, uy: float, wheels: Wheels, i: int) -> tuple[float, float]:
    """Wheel speeds, rad/s, within the limits of robot i for a velocity of its projected point, m/s."""
    limit, v = wheels.limits[i], ux / wheels.radius
    turning = uy / wheels.projections[i] * wheels.half_base / wheels.radius
    left, right = v - turning, v + turning
    if wheels.saturation == SCALE:
        share = limit / max(abs(left), abs(right), limit)
        left, right = left * share, right * share
    elif wheels.saturation == CLIP:
        left, right = min(max(left, -limit), limit), min(max(right, -limit), limit)
    return left, right


@compiled
def roll(state: Real, wheels: Wheels, period: float) -> None:
    """Drive all robots by their commands UX, UY for one period, seconds: NID, wheels, exact arcs."""
    r, half_base = wheels.radius, wheels.half_base
    halves, sines, cosines = wheels.room[0], wheels.room[1], wheels.room[2]  # of the turns
    for i in range(state.shape[1]):
        ahead = wheels.projections[i]
        for m in range(state.shape[2]):
            left, right = wheel_speeds(state[UX, i, m], state[UY, i, m], wheels, i)
            state[LEFT, i, m], state[RIGHT, i, m] = left, right
            halves[m] = 0.25 * period * r / half_base * (right - left)
        if wheels.saturation != UNLIMITED and 0.5 * period * r / half_base * wheels.limits[i] < WITHIN:
            for m in range(state.shape[2]):  # limited wheels turn little: a quarter less time
                sines[m], cosines[m] = sine_cosine_within(halves[m])
        else:
            for m in range(state.shape[2]):
                sines[m], cosines[m] = sine_cosine(halves[m])
        for m in range(state.shape[2]):
            half, sine, cosine = halves[m], sines[m], cosines[m]
            length = 0.5 * period * r * (state[RIGHT, i, m] + state[LEFT, i, m])
            chord = length * (sine / half if half != 0.0 else 1.0)
            c, s = state[COS, i, m], state[SIN, i, m]
            c, s = c * cosine - s * sine, s * cosine + c * sine  # half of the turn is done: the chord's direction
            state[X, i, m] += chord * c
            state[Y, i, m] += chord * s
            state[THETA, i, m] += 2.0 * half
            c, s = c * cosine - s * sine, s * cosine + c * sine
            unit = 1.5 - 0.5 * (c * c + s * s)  # one Newton step to length 1
            c, s = c * unit, s * unit
            state[COS, i, m], state[SIN, i, m] = c, s
            state[PX, i, m] = state[X, i, m] + ahead * c
            state[PY, i, m] = state[Y, i, m] + ahead * s
