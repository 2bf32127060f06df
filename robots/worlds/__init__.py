"""Four worlds behind one protocol, from the theorem's points to bodies with mass.

A run on each rung from one seed tells how much of an error the theory, the map, the wheels and the contacts bring.
A world does not know what is commanded, nor why.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robots.arena import Arena
from robots.drive import Saturation
from robots.measured.model import MeasuredModel
from robots.model import Chassis, RobotModel
from robots.nid import NearIdentityDiffeomorphism
from robots.worlds.kinematic import Saturated as Saturated
from robots.worlds.kinematic import SingleIntegrator as SingleIntegrator
from robots.worlds.kinematic import Unicycle as Unicycle
from robots.worlds.protocol import NOTHING as NOTHING
from robots.worlds.protocol import Controller as Controller
from robots.worlds.protocol import Real
from robots.worlds.protocol import UnsupportedVersionError as UnsupportedVersionError
from robots.worlds.protocol import World as World

__all__ = [
    "Controller",
    "NOTHING",
    "PLANTS",
    "Saturated",
    "SingleIntegrator",
    "Unicycle",
    "UnsupportedVersionError",
    "World",
    "make_world",
]

PLANTS = ("single_integrator", "unicycle", "saturated", "pymunk")
"""The worlds by the name that scenario files and the command line use, from the simplest to the most real."""


MEASURED_PLANTS = ("saturated", "pymunk")
"""The worlds that measured robots can move in."""


def make_world(
    plant: str,
    points: Real,
    theta: Real,
    *,
    nid: NearIdentityDiffeomorphism,
    robot: RobotModel,
    saturation: Saturation = "scale",
    arena: Arena | None = None,
    measured: MeasuredModel | None = None,
    generators: Sequence[np.random.Generator] = (),
    bodies: Sequence[Chassis] | None = None,
    steps: int = 1,
) -> World:
    """The world named ``plant`` with projected points (..., n, 2), metres, and headings theta (..., n), radians.

    ``single_integrator`` has no bodies: its poses are the points themselves, integrated in so many ``steps`` a control
    period. With ``measured`` the robots of
    ``saturated`` and ``pymunk`` stand behind their firmware and under cameras, with random streams spawned from the
    runs' ``generators``. ``bodies`` are the n chassis where they are not all that of ``robot``.

    Raises:
        ValueError: ``plant`` is not one of :data:`PLANTS`, or is not one of :data:`MEASURED_PLANTS` and ``measured``.
    """
    if measured is not None:
        return _measured(plant, nid.poses(points, theta), nid, robot, saturation, arena, measured, generators)
    if plant == "single_integrator":
        return SingleIntegrator(points, theta, steps)
    poses = nid.poses(points, theta)
    if plant == "unicycle":
        return Unicycle(poses, nid, robot.drive)
    if plant == "saturated":
        return Saturated(poses, nid, robot.drive, saturation)
    if plant == "pymunk":
        from robots.worlds.contact import Contact  # pymunk is loaded only where bodies collide

        return Contact(poses, nid, robot, saturation, arena, bodies=bodies)
    raise ValueError(f"plant must be one of {', '.join(PLANTS)}, got {plant!r}")


def _measured(
    plant: str,
    poses: Real,
    nid: NearIdentityDiffeomorphism,
    robot: RobotModel,
    saturation: Saturation,
    arena: Arena | None,
    model: MeasuredModel,
    generators: Sequence[np.random.Generator],
) -> World:
    from robots.measured.world import Body, Measured

    if plant not in MEASURED_PLANTS:
        raise ValueError(f"measured robots move in {' or '.join(MEASURED_PLANTS)}, got {plant!r}")
    body: Body = Saturated(poses, nid, robot.drive, saturation)
    if plant == "pymunk":
        from robots.worlds.contact import Contact

        body = Contact(poses, nid, robot, saturation, arena)
    return Measured(body, nid, robot.drive, saturation, model, generators)
