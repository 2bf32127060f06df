"""The world with mass, traction, contact, walls and obstacles, on pymunk (Chipmunk 2-D).

Each chassis is a dynamic box, its centre of mass ahead of the axle. It hangs on a massless kinematic body that moves as
the wheels command, by two joints without position correction:

- a pivot at the axle's centre, whose largest force is the tyres' traction mu m g. It drives forward and, because tyres
  do not slide sideways until that same limit, resists lateral motion;
- a gear, whose largest torque is mu m g b / 2: each wheel carries half the weight at half the base from the centre.

The solver meets both limits jointly with all contacts, so a robot that is pushed harder than its tyres hold yields, and
two robots that push each other stop. The chassis is never moved or given a velocity from outside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk

from robots.arena import Arena
from robots.drive import Saturation
from robots.model import Chassis as Box
from robots.model import RobotModel
from robots.nid import NearIdentityDiffeomorphism, mapped
from robots.worlds.bodies import Chassis, move
from robots.worlds.chipmunk import BODY_ANGLE, bodies_of
from robots.worlds.protocol import Controller, Index, Real

SUBSTEPS = 4
"""Solver steps per control period; keeps the deepest overlap of two chassis near 2 mm."""

WALL_THICKNESS = 0.05
"""Metres; the inner faces of the walls are the sides of the arena."""


class Contact:
    """Differential-drive bodies in a pymunk space.

    Attributes:
        space: the pymunk space; bodies 0..n-1 are the chassis, n..2n-1 their kinematic partners.
        bodies: the same for compiled code; the state as it was observed last.
        chassis: the robots on them, likewise.
    """

    def __init__(
        self,
        poses: Real,
        nid: NearIdentityDiffeomorphism,
        robot: RobotModel,
        saturation: Saturation = "scale",
        arena: Arena | None = None,
        substeps: int = SUBSTEPS,
        bodies: Sequence[Box] | None = None,
    ) -> None:
        self.poses = np.array(poses, dtype=np.float64)
        if self.poses.ndim != 2:
            raise ValueError(f"the pymunk world holds one run, poses of shape (n, 3), got {self.poses.shape}")
        self._n = n = len(self.poses)
        self._drive, self._saturation = robot.drive, saturation
        chassis = [robot.chassis] * n if bodies is None else list(bodies)
        self._l = nid.ahead
        self._to_wheels = (robot.drive.to_wheels @ nid.to_twist).swapaxes(-1, -2)
        self._to_twist = robot.drive.to_twist.T
        self.space = _space(self.poses, robot, chassis, arena)
        self._obstacles = () if arena is None else _obstacles(self.space, arena, robot.chassis.body_friction)
        self.space.add(*self._obstacles)
        self._sliding = np.array([[2.0 * each.traction_limit / each.mass] for each in chassis])
        self.wheel_speeds = np.zeros((n, 2))
        self.bodies, self._kept = bodies_of(self.space, list(self.space.bodies)[:n])
        ahead = np.array([each.centre_offset for each in chassis])
        self.chassis = Chassis(self.bodies, ahead, substeps, np.zeros((n, 2)))
        self._observe()

    @property
    def seen(self) -> tuple[Real, Real]:
        return self.points, self.headings

    def step(self, controller: Controller, period: float) -> None:
        wheels = mapped(controller(self.points, self.headings, 0.0), self._to_wheels)
        self.wheel_speeds = self._drive.saturate(wheels, self._saturation)
        self.move(self.wheel_speeds @ self._to_twist, period)

    def move(self, twist: Real, period: float) -> None:
        """Advance by a period, seconds, while the wheels command twists (n, 2) of the axles, m/s and rad/s."""
        self.chassis.twist[:] = twist
        move(self.chassis, period)
        self._observe()

    def push(self, displacement: Real) -> None:
        """The impulse at the centre of mass with which a body whose tyres slide, 2 mu g d = v^2, comes so far."""
        distance = np.linalg.norm(displacement, axis=-1, keepdims=True)
        speed = np.sqrt(self._sliding * distance)
        direction = np.divide(displacement, distance, out=np.zeros_like(displacement), where=distance > 0.0)
        self.bodies.command[: self._n, :2] += speed * direction

    def stand(self, there: Sequence[bool]) -> None:
        present = set(self.space.shapes)
        for shape, stands in zip(self._obstacles, there, strict=True):
            if stands and shape not in present:
                self.space.add(shape)
            elif shape in present and not stands:
                self.space.remove(shape)

    def _observe(self) -> None:
        chassis = self.bodies.state[: self._n]
        theta = chassis[:, BODY_ANGLE]
        self.headings = np.exp(1j * theta)[:, None].view(np.float64)
        axle = chassis[:, :2] - self.chassis.ahead[:, None] * self.headings
        self.poses[:, :2] = axle
        self.poses[:, 2] = theta
        self.points = axle + self._l * self.headings
        self.contacts: Index = self.bodies.touched.copy()


def _space(poses: Real, robot: RobotModel, boxes: Sequence[Box], arena: Arena | None) -> pymunk.Space:
    space = pymunk.Space()
    space.collision_slop = 1e-4  # the default of 0.1 m would let robots sink into each other by their own size
    bodies = []
    for (x, y, theta), chassis in zip(poses.tolist(), boxes, strict=True):
        ahead = chassis.centre_offset
        body = pymunk.Body(chassis.mass, chassis.inertia)
        body.position = x + ahead * np.cos(theta), y + ahead * np.sin(theta)
        body.angle = theta
        box = pymunk.Poly.create_box(body, (chassis.length, chassis.width))
        box.friction = chassis.body_friction
        space.add(body, box)
        bodies.append(body)
    for body, chassis in zip(bodies, boxes, strict=True):
        traction, ahead = chassis.traction_limit, chassis.centre_offset
        partner = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        partner.position = body.local_to_world((-ahead, 0.0))
        pivot = pymunk.PivotJoint(partner, body, (0.0, 0.0), (-ahead, 0.0))
        pivot.max_force = traction
        gear = pymunk.GearJoint(partner, body, 0.0, 1.0)
        gear.max_force = traction * robot.drive.base_length / 2.0
        for joint in (pivot, gear):
            joint.max_bias = 0.0
        space.add(partner, pivot, gear)
    if arena is not None and arena.walls:
        space.add(*_walls(space, arena, robot.chassis.body_friction))
    return space


def _walls(space: pymunk.Space, arena: Arena, friction: float) -> Sequence[pymunk.Shape]:
    radius = WALL_THICKNESS / 2.0
    corners = arena.corners + radius * np.sign(arena.corners - arena.corners.mean(axis=0))
    walls = []
    for a, b in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True):
        wall = pymunk.Segment(space.static_body, tuple(a), tuple(b), radius)
        wall.friction = friction
        walls.append(wall)
    return walls


def _obstacles(space: pymunk.Space, arena: Arena, friction: float) -> Sequence[pymunk.Shape]:
    shapes: list[pymunk.Shape] = []
    for obstacle in arena.obstacles:
        vertices = [tuple(vertex) for vertex in obstacle.vertices.tolist()]
        match len(vertices):
            case 1:
                shape: pymunk.Shape = pymunk.Circle(space.static_body, obstacle.radius, vertices[0])
            case 2:
                shape = pymunk.Segment(space.static_body, vertices[0], vertices[1], obstacle.radius)
            case _:
                shape = pymunk.Poly(space.static_body, vertices, radius=obstacle.radius)
        shape.friction = friction
        shapes.append(shape)
    return shapes
