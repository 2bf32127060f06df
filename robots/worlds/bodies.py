"""Robots on Chipmunk's bodies, compiled: from what the wheels command to where the robots are after a control period.

:mod:`robots.worlds.contact` builds the bodies and says why they move as they do; no body is made or taken away here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, program
from robots.worlds.chipmunk import BODY_ANGLE, BODY_VX, BODY_X, BODY_Y, Bodies, drive, no_bodies
from robots.worlds.lanes import (
    CONTACT,
    COS,
    LEFT,
    PX,
    PY,
    RIGHT,
    SIN,
    THETA,
    UX,
    UY,
    Wheels,
    X,
    Y,
    sine_cosine,
    wheel_speeds,
)

Real = NDArray[np.float64]


class Chassis(NamedTuple):
    """The chassis of n robots and their kinematic partners, behind them in the space.

    Attributes:
        bodies: of the space; watched are the chassis.
        ahead: (n,) from each axle's centre to the centre of mass, metres.
        substeps: of the solver in a control period.
        twist: (n, 2) room for what the wheels command, m/s and rad/s.
    """

    bodies: Bodies
    ahead: Real
    substeps: int
    twist: Real


def no_chassis() -> Chassis:
    """In the place of chassis for robots that have none."""
    return Chassis(no_bodies(), np.zeros(0), 0, np.zeros((0, 2)))


@program
def move(chassis: Chassis, period: float) -> None:
    """Let the robots move for a period, seconds, while their wheels command :attr:`Chassis.twist`.

    A partner moves along the chord of the arc that the wheels command over the whole period. The solver moves bodies
    before it gives them new velocities, so that arc begins one substep from now.
    """
    bodies, n, dt = chassis.bodies, len(chassis.twist), period / chassis.substeps
    state, command = bodies.state, bodies.command
    for i in range(n):
        v, turning = chassis.twist[i, 0], chassis.twist[i, 1]
        half = 0.5 * period * turning
        sine, _ = sine_cosine(half)
        speed = v * (sine / half if half != 0.0 else 1.0)
        sine, cosine = sine_cosine(state[i, BODY_ANGLE] + dt * command[i, 2] + half)
        command[n + i, 0], command[n + i, 1], command[n + i, 2] = speed * cosine, speed * sine, turning
    drive(bodies, chassis.substeps, dt)
    for i in range(n):
        for axis in range(command.shape[1]):
            command[i, axis] = state[i, BODY_VX + axis]  # written back unchanged with the next command


@compiled
def shove(state: Real, wheels: Wheels, chassis: Chassis, period: float) -> None:
    """Drive the robots of one run (FIELDS, n, 1) by their commands UX, UY for a period, seconds."""
    for i in range(state.shape[1]):
        left, right = wheel_speeds(state[UX, i, 0], state[UY, i, 0], wheels, i)
        state[LEFT, i, 0], state[RIGHT, i, 0] = left, right
        chassis.twist[i, 0] = 0.5 * wheels.radius * (right + left)
        chassis.twist[i, 1] = 0.5 * wheels.radius / wheels.half_base * (right - left)
    move(chassis, period)
    for i in range(state.shape[1]):
        body, ahead, projection = chassis.bodies.state[i], chassis.ahead[i], wheels.projections[i]
        sine, cosine = sine_cosine(body[BODY_ANGLE])
        x, y = body[BODY_X] - ahead * cosine, body[BODY_Y] - ahead * sine
        state[X, i, 0], state[Y, i, 0], state[THETA, i, 0] = x, y, body[BODY_ANGLE]
        state[COS, i, 0], state[SIN, i, 0] = cosine, sine
        state[PX, i, 0], state[PY, i, 0] = x + projection * cosine, y + projection * sine
        state[CONTACT, i, 0] = chassis.bodies.touched[i]
