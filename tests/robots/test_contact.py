"""The world with mass: exact arcs on free floor, traction, contact, walls."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots import GTERNAL, ROBOTARIUM_FLOOR, Arena, DifferentialDrive, NearIdentityDiffeomorphism
from robots.obstacles import disc
from robots.worlds import NOTHING
from robots.worlds.contact import Contact

NID = NearIdentityDiffeomorphism(0.025)
CHASSIS = GTERNAL.chassis
PERIOD = 0.033
UNLIMITED = dataclasses.replace(GTERNAL, drive=DifferentialDrive(0.016, 0.11, 1e6))


def world(poses: list[tuple[float, float, float]], **keys: object) -> Contact:
    return Contact(np.array(poses, dtype=float), NID, GTERNAL, **keys)  # type: ignore[arg-type]


def drive(contact: Contact, *twists: tuple[float, float], periods: int) -> None:
    """Command constant twists (v, omega), one per robot."""
    velocity = NID.velocity(np.array(twists))
    for _ in range(periods):
        contact.step(lambda points, headings, _: velocity, PERIOD)


def arc(pose: np.ndarray, v: float, omega: float, time: float) -> np.ndarray:
    """Where a unicycle at constant twist is after ``time`` seconds."""
    x, y, theta = pose
    chord = v * time * np.sinc(omega * time / 2.0 / np.pi)
    middle = theta + omega * time / 2.0
    return np.array([x + chord * np.cos(middle), y + chord * np.sin(middle), theta + omega * time])


@settings(max_examples=25)
@given(st.floats(-0.2, 0.2), st.floats(-1.0, 1.0), st.floats(-np.pi, np.pi))
def test_one_robot_on_free_floor_follows_the_exact_arc_beyond_start_up(v: float, share: float, theta: float) -> None:
    """Within 2 mm and 0.02 rad after 10 s, over all twists that the wheels can drive."""
    omega = share * (0.2 - abs(v)) / (GTERNAL.drive.base_length / 2.0)
    contact = world([(0.2, -0.1, theta)])
    drive(contact, (v, omega), periods=3)
    begun = contact.poses[0].copy()
    drive(contact, (v, omega), periods=303)
    expected = arc(begun, v, omega, 303 * PERIOD)
    assert np.linalg.norm(contact.poses[0, :2] - expected[:2]) < 2e-3
    assert abs(contact.poses[0, 2] - expected[2]) < 0.02


def test_start_up_costs_less_way_than_one_period() -> None:
    """One substep until the command acts, then the tyres' acceleration."""
    for v in (0.02, 0.1, 0.2):
        contact = world([(0.0, 0.0, 0.0)])
        drive(contact, (v, 0.0), periods=30)
        lost = v * 30 * PERIOD - contact.poses[0, 0]
        assert v * PERIOD / 4.0 - 1e-9 <= lost < v * PERIOD


def test_a_turning_robot_does_not_slip_sideways() -> None:
    """The axle moves along its own mean heading in every period; the partner's chord begins where the solver begins."""
    contact = world([(0.0, 0.0, 0.0)])
    lateral = []
    for period in range(300):
        before = contact.poses[0].copy()
        drive(contact, (0.12, 1.2 * np.sin(0.05 * period)), periods=1)
        step = contact.poses[0] - before
        middle = before[2] + step[2] / 2.0
        lateral.append(step[1] * np.cos(middle) - step[0] * np.sin(middle))
    assert np.abs(np.cumsum(lateral)).max() < 1e-4


@pytest.mark.parametrize("direction", [0.0, np.pi / 2.0, np.pi, 0.7])
@pytest.mark.parametrize(("share", "yields"), [(0.9, False), (1.1, True)])
def test_a_robot_yields_to_a_push_beyond_its_traction_and_to_no_weaker_one(
    direction: float, share: float, yields: bool
) -> None:
    """A horizontal force through the axle's centre, for one second; the robot is told to stand."""
    contact = world([(0.0, 0.0, 0.3)], substeps=1)
    body = next(iter(contact.space.bodies))
    force = share * CHASSIS.traction_limit * np.array([np.cos(direction), np.sin(direction)])
    for _ in range(30):
        axle = body.local_to_world((-CHASSIS.centre_offset, 0.0))
        body.apply_force_at_world_point(tuple(force.tolist()), axle)  # the solver clears it after each step
        contact.step(lambda points, headings, _: np.zeros((1, 2)), PERIOD)
    moved = np.linalg.norm(contact.poses[0, :2])
    assert moved > 0.05 if yields else moved < 1e-6


@pytest.mark.parametrize(("share", "yields"), [(0.9, False), (1.1, True)])
def test_a_robot_turns_under_a_torque_beyond_its_tyres_and_under_no_weaker_one(share: float, yields: bool) -> None:
    contact = world([(0.0, 0.0, 0.0)], substeps=1)
    body = next(iter(contact.space.bodies))
    limit = CHASSIS.traction_limit * GTERNAL.drive.base_length / 2.0
    for _ in range(30):
        body.torque = share * limit
        contact.step(lambda points, headings, _: np.zeros((1, 2)), PERIOD)
    turned = abs(contact.poses[0, 2])
    assert turned > 0.05 if yields else turned < 1e-6


def test_no_robot_accelerates_faster_than_its_tyres_hold() -> None:
    contact = Contact(np.zeros((1, 3)), NID, UNLIMITED, substeps=1)
    speeds = []
    for _ in range(20):
        before = contact.poses[0, 0]
        drive(contact, (2.0, 0.0), periods=1)
        speeds.append((contact.poses[0, 0] - before) / PERIOD)
    limit = CHASSIS.traction_limit / CHASSIS.mass
    assert np.diff(speeds).max() / PERIOD == pytest.approx(limit, rel=1e-6)
    assert speeds[-1] == pytest.approx(2.0, rel=1e-6)


def test_two_robots_driven_head_on_stop_each_other() -> None:
    contact = world([(-0.2, 0.0, 0.0), (0.2, 0.0, np.pi)])
    drive(contact, (0.2, 0.0), (0.2, 0.0), periods=150)
    gap = contact.poses[1, 0] - contact.poses[0, 0]
    bodies = CHASSIS.length + 2.0 * CHASSIS.centre_offset
    assert bodies - 3e-3 < gap < bodies + 1e-3
    assert contact.poses[:, 0].sum() == pytest.approx(0.0, abs=1e-3)


def test_a_robot_cannot_shove_two_that_stand() -> None:
    """One robot's traction is not enough to break that of two."""
    touching = CHASSIS.length + 1e-4
    contact = world([(0.0, 0.0, 0.0), (touching, 0.0, 0.0), (2.0 * touching, 0.0, 0.0)])
    drive(contact, (0.2, 0.0), (0.0, 0.0), (0.0, 0.0), periods=90)
    assert np.abs(contact.poses[1:, 0] - [touching, 2.0 * touching]).max() < 5e-3


@pytest.mark.parametrize("theta", [0.0, np.pi / 2.0, np.pi, -np.pi / 2.0, 0.4])
def test_walls_stop_a_chassis_at_the_arenas_sides(theta: float) -> None:
    contact = world([(0.0, 0.0, theta)], arena=ROBOTARIUM_FLOOR)
    drive(contact, (0.2, 0.0), periods=600)
    turn = contact.poses[0, 2]
    rotated = CHASSIS.outline @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    corners = contact.poses[0, :2] + rotated
    assert np.abs(corners[:, 0]).max() < 1.6 + 2e-3
    assert np.abs(corners[:, 1]).max() < 1.0 + 2e-3
    assert (1.6 - np.abs(corners[:, 0])).min() < 2e-3 or (1.0 - np.abs(corners[:, 1])).min() < 2e-3


def test_walls_and_obstacles_never_move() -> None:
    arena = dataclasses.replace(ROBOTARIUM_FLOOR, obstacles=(disc((0.5, 0.0), 0.1),))
    contact = world([(0.0, 0.0, 0.0)], arena=arena)
    drive(contact, (0.2, 0.0), periods=200)
    assert contact.space.static_body.velocity == (0.0, 0.0)
    assert contact.space.static_body.angular_velocity == 0.0


@pytest.mark.parametrize("arena", [None, dataclasses.replace(ROBOTARIUM_FLOOR, walls=False)])
def test_an_open_floor_stops_nobody(arena: Arena | None) -> None:
    contact = world([(1.4, 0.0, 0.0)], arena=arena)
    drive(contact, (0.2, 0.0), periods=100)
    assert contact.poses[0, 0] == pytest.approx(1.4 + 0.2 * 100 * PERIOD, abs=0.2 * PERIOD)


def test_more_substeps_let_two_robots_overlap_less() -> None:
    def deepest(substeps: int) -> float:
        """Over starts that let the robots meet at different times within a substep."""
        overlap = 0.0
        for apart in np.linspace(0.4, 0.42, 9):
            contact = world([(0.0, 0.0, 0.0), (apart, 0.0, np.pi)], substeps=substeps)
            for _ in range(50):
                drive(contact, (0.2, 0.0), (0.2, 0.0), periods=1)
                gap = contact.poses[1, 0] - contact.poses[0, 0] - 2.0 * CHASSIS.centre_offset - CHASSIS.length
                overlap = max(overlap, -gap)
        return overlap

    assert deepest(8) < deepest(4) < deepest(1)
    assert deepest(4) < 3e-3


def test_a_robot_far_away_is_not_moved_by_a_crash() -> None:
    contact = world([(-0.2, 0.0, 0.0), (0.2, 0.0, np.pi), (0.0, 0.8, 1.0)])
    drive(contact, (0.2, 0.0), (0.2, 0.0), (0.0, 0.0), periods=100)
    np.testing.assert_allclose(contact.poses[2], [0.0, 0.8, 1.0], atol=1e-12)


def test_the_bodies_hold_one_run_only() -> None:
    with pytest.raises(ValueError, match=r"poses of shape \(n, 3\), got \(2, 1, 3\)"):
        Contact(np.zeros((2, 1, 3)), NID, GTERNAL)


def test_only_robots_that_touch_something_are_reported_and_only_while_they_do() -> None:
    """Robot 0 drives at robot 1 until it pushes it, and backs away; robot 2 stands by."""
    contact = world([(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.5, 0.0)])
    while contact.points[1, 0] - contact.points[0, 0] > CHASSIS.length + 1e-3:
        assert (contact.contacts == NOTHING).all()
        drive(contact, (0.1, 0.0), (0.0, 0.0), (0.0, 0.0), periods=1)
    drive(contact, (0.1, 0.0), (0.0, 0.0), (0.0, 0.0), periods=3)
    assert contact.contacts.tolist() == [1, 0, NOTHING]
    drive(contact, (-0.1, 0.0), (0.0, 0.0), (0.0, 0.0), periods=10)
    assert (contact.contacts == NOTHING).all()


def test_a_wall_is_touched_by_the_robot_alone() -> None:
    contact = world([(0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)], arena=Arena(x=(-1.0, 0.2), y=(-1.0, 1.0), walls=True))
    drive(contact, (0.1, 0.0), (0.0, 0.0), periods=90)
    assert contact.contacts.tolist() == [2, NOTHING]
