"""The robot: one place for every physical constant, with its unit and its source."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism

STANDARD_GRAVITY = 9.80665
"""m/s^2 (CGPM 1901)."""


@dataclass(frozen=True)
class Chassis:
    """The rigid body that the drive carries, a box whose centre is also its centre of mass.

    Attributes:
        length: along the heading, metres.
        width: across the heading, metres.
        centre_offset: from the axle's centre ahead to the box's centre, metres.
        mass: kilograms.
        tyre_friction: coefficient between tyres and floor; traction is at most tyre_friction * mass * g.
        body_friction: coefficient between two chassis, or a chassis and a wall.

    Raises:
        ValueError: a quantity is not finite, or not positive where it has to be.
    """

    length: float
    width: float
    centre_offset: float
    mass: float
    tyre_friction: float
    body_friction: float

    def __post_init__(self) -> None:
        for field in ("length", "width", "mass"):
            value = getattr(self, field)
            if not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"{field} must be a positive number, got {value}")
        for field in ("centre_offset", "tyre_friction", "body_friction"):
            value = getattr(self, field)
            if not (np.isfinite(value) and value >= 0.0):
                raise ValueError(f"{field} must be a number that is not negative, got {value}")

    @property
    def traction_limit(self) -> float:
        """Largest force between tyres and floor, newtons."""
        return self.tyre_friction * self.mass * STANDARD_GRAVITY

    @property
    def inertia(self) -> float:
        """Moment of inertia of the uniform box about its centre, kg m^2."""
        return self.mass * (self.length**2 + self.width**2) / 12.0

    @property
    def radius(self) -> float:
        """Of the smallest circle about the box's centre that contains the box, metres."""
        return float(np.hypot(self.length, self.width) / 2.0)

    @property
    def outline(self) -> np.ndarray:
        """(4, 2) corners of the box, metres, counter-clockwise, in the frame of the axle's centre."""
        x, y = self.length / 2.0, self.width / 2.0
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]]) + [self.centre_offset, 0.0]


@dataclass(frozen=True)
class RobotModel:
    """A differential-drive robot: its drive and its chassis."""

    drive: DifferentialDrive
    chassis: Chassis


@dataclass(frozen=True, eq=False)
class Fleet:
    """The robots of a run, which may differ.

    Attributes:
        drive: of all; its wheels' limit is (n,) where robots differ.
        nid: where the projected points are; (n,) likewise.
        bodies: the n chassis.
    """

    drive: DifferentialDrive
    nid: NearIdentityDiffeomorphism
    bodies: tuple[Chassis, ...]

    @property
    def outlines(self) -> np.ndarray:
        """(n, 4, 2) corners of the chassis, metres, each in the frame of its axle's centre."""
        return np.stack([body.outline for body in self.bodies])

    @property
    def widest(self) -> float:
        """The largest width of a chassis, metres."""
        return max(body.width for body in self.bodies)


CONTROL_PERIOD = 0.033
"""Seconds between two commands (Robotarium Python simulator, ``rps`` 2.1)."""

COLLISION_CENTRE = 0.025
"""Metres from the axle's centre ahead to the point that the Robotarium checks for collisions (``rps`` 2.1)."""

ENCODER_COUNTS_PER_TURN = 28 * 100
"""Encoder counts per turn of a wheel: 28 of the motor's shaft, gears of 1:100 (``rps`` 2.1; the robots' firmware)."""

GTERNAL = RobotModel(
    drive=DifferentialDrive(
        wheel_radius=0.016,  # m, rps 2.1
        base_length=0.11,  # m, rps 2.1 (the MATLAB simulator says 0.105)
        wheel_speed_limit=12.5,  # rad/s, rps 2.1: 0.2 m/s forward, 3.636 rad/s turning; the paper says 0.2 and 3.6
    ),
    chassis=Chassis(
        length=0.10,  # m, the paper, Section 4
        width=0.11,  # m, the paper, Section 4
        centre_offset=COLLISION_CENTRE,
        mass=0.2,  # kg, assumed: only ratios of forces to mass enter the motion
        tyre_friction=0.8,  # rubber on a hard floor, assumed
        body_friction=0.0,  # smooth shells, assumed: with 0.3 robots that follow the law literally jam, README
    ),
)
"""The Robotarium's robot."""
