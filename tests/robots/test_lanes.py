"""The compiled unicycle drives every robot of every run as the plain one does, whatever its wheels."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots import GTERNAL, NearIdentityDiffeomorphism
from robots.drive import Saturation
from robots.worlds import lanes
from robots.worlds.bodies import shove
from robots.worlds.contact import Contact
from robots.worlds.kinematic import Saturated, Unicycle
from robots.worlds.lanes import COS, LEFT, PX, PY, RIGHT, SIN, THETA, UX, UY, X, Y, new_state, roll, wheels
from robots.worlds.protocol import NOTHING

SEEDS = st.integers(0, 2**32 - 1)
N, RUNS, PERIOD = 3, 2, 0.2
Plain = Callable[..., Any]


@pytest.mark.parametrize("saturation", [None, "scale", "clip"])
@settings(max_examples=10)
@given(seed=SEEDS)
def test_a_period_of_the_lanes_is_one_of_the_plain_unicycle(
    saturation: Saturation | None, seed: int, plain: Plain
) -> None:
    rng = np.random.default_rng(seed)
    nid = NearIdentityDiffeomorphism(0.04)
    poses = rng.uniform(-3.0, 3.0, (RUNS, N, 3))
    state = new_state(poses, 0.04)
    drive = GTERNAL.drive
    constants = wheels(drive, nid, saturation, N, RUNS)
    one_by_one = Unicycle(poses, nid, drive)
    if saturation is not None:
        one_by_one = Saturated(poses, nid, drive, saturation)
    for _ in range(4):
        commands = rng.normal(0.0, 0.2, (RUNS, N, 2))
        state[UX], state[UY] = commands[..., 0].T, commands[..., 1].T
        plain(roll)(state, constants, PERIOD)
        one_by_one.step(lambda points, headings, _, commands=commands: commands, PERIOD)
        np.testing.assert_allclose(state[[X, Y, THETA]].T, one_by_one.poses.transpose(0, 1, 2), atol=1e-13)
        np.testing.assert_allclose(state[[LEFT, RIGHT]].T, one_by_one.wheel_speeds, atol=1e-12)
        np.testing.assert_allclose(state[[PX, PY]].T, one_by_one.points, atol=1e-13)
        np.testing.assert_allclose(state[[COS, SIN]].T, one_by_one.headings, atol=1e-13)


def test_every_robot_has_its_own_limit_and_its_own_point_ahead(plain: Plain) -> None:
    drive, ahead = GTERNAL.drive, np.array([0.02, 0.05, 0.1])
    constants = wheels(drive, NearIdentityDiffeomorphism(ahead), "scale", N, 1)
    limits = np.array([1.0, 2.0, 4.0])
    constants = constants._replace(limits=limits)
    state = new_state(np.zeros((1, N, 3)), ahead[:, None])
    state[UX] = 1.0
    plain(roll)(state, constants, PERIOD)
    np.testing.assert_allclose(state[LEFT, :, 0], limits)
    np.testing.assert_allclose(state[RIGHT, :, 0], limits)
    np.testing.assert_allclose(state[PX, :, 0], ahead + limits * drive.wheel_radius * PERIOD)


@given(turn=st.floats(-300.0, 300.0), theta=st.floats(-3.0, 3.0))
def test_headings_stay_unit_vectors_of_the_angle_that_is_counted(turn: float, theta: float, plain: Plain) -> None:
    """Half of the turn is what the polynomials of sine and cosine see, in any quadrant."""
    nid = NearIdentityDiffeomorphism(0.04)
    state = new_state(np.array([[[0.0, 0.0, theta]]]), 0.04)
    state[UY] = 0.04 * turn / PERIOD
    plain(roll)(state, wheels(GTERNAL.drive, nid, None, 1, 1), PERIOD)
    heading = complex(state[COS, 0, 0], state[SIN, 0, 0])
    assert state[THETA, 0, 0] == pytest.approx(theta + turn, abs=1e-12)
    assert abs(heading - np.exp(1j * (theta + turn))) < 1e-13 * max(1.0, abs(turn))
    assert abs(abs(heading) - 1.0) < 1e-15


def test_a_new_state_shows_its_poses_and_robots_that_touch_nobody_and_turn_left() -> None:
    poses = np.random.default_rng(0).normal(size=(RUNS, N, 3))
    state = new_state(poses, 0.04)
    assert state.shape == (lanes.FIELDS, N, RUNS)
    np.testing.assert_array_equal(state[[X, Y, THETA]].T, poses)
    np.testing.assert_array_equal(state[COS].T, np.cos(poses[..., 2]))
    np.testing.assert_array_equal(state[SIN].T, np.sin(poses[..., 2]))
    np.testing.assert_allclose(state[PX], state[X] + 0.04 * state[COS])
    np.testing.assert_allclose(state[PY], state[Y] + 0.04 * state[SIN])
    assert (state[[lanes.SIDE, lanes.ACTIVE]] == 1.0).all()
    assert (state[lanes.CONTACT] == NOTHING).all()
    rest = set(range(lanes.FIELDS)) - {X, Y, THETA, COS, SIN, PX, PY, lanes.SIDE, lanes.ACTIVE, lanes.CONTACT}
    assert not state[sorted(rest)].any()
    still = lanes.at_rest(N, RUNS)
    assert (still[COS] == 1.0).all()
    assert not still[[X, Y, THETA, SIN, PX, PY]].any()


def test_a_lane_of_robots_with_bodies_is_the_world_with_mass(plain: Plain) -> None:
    """Its loop over robots runs without the compiler here, Chipmunk's own step with it, as in every run."""
    nid, drive = NearIdentityDiffeomorphism(0.04), GTERNAL.drive
    poses = np.array([[0.0, 0.0, 0.3], [0.16, 0.02, 3.0], [-0.5, 0.4, -1.0]])
    world, other = Contact(poses, nid, GTERNAL, "scale"), Contact(poses, nid, GTERNAL, "scale")
    state, constants = new_state(poses[None], 0.04), wheels(drive, nid, "scale", N, 1)
    rng, touched = np.random.default_rng(1), False
    for _ in range(30):
        commands = rng.normal(0.0, 0.05, (N, 2)) + [0.15, 0.0]
        state[UX, :, 0], state[UY, :, 0] = commands.T
        plain(shove, ("move",))(state, constants, other.chassis, PERIOD)
        world.step(lambda points, headings, _, commands=commands: commands, PERIOD)
        np.testing.assert_allclose(state[[X, Y, THETA], :, 0].T, world.poses, atol=1e-9)
        np.testing.assert_allclose(state[[LEFT, RIGHT], :, 0].T, world.wheel_speeds, atol=1e-9)
        np.testing.assert_allclose(state[[PX, PY], :, 0].T, world.points, atol=1e-9)
        np.testing.assert_allclose(state[[COS, SIN], :, 0].T, world.headings, atol=1e-9)
        assert state[lanes.CONTACT, :, 0].tolist() == world.contacts.tolist()
        touched |= bool((world.contacts != NOTHING).any())
    assert touched
