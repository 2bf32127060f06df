"""Chipmunk from compiled code against pymunk's public way, and against a pymunk that lacks what is needed."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from pymunk import batch

from robots import GTERNAL, ROBOTARIUM_FLOOR, NearIdentityDiffeomorphism
from robots.worlds import chipmunk
from robots.worlds.contact import Contact
from robots.worlds.protocol import NOTHING

NID = NearIdentityDiffeomorphism(0.025)
STATE = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
COMMAND = batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
DT = 0.033 / 4


def crowd(seed: int, n: int) -> Contact:
    """Robots so close that they touch, between walls."""
    rng = np.random.default_rng(seed)
    poses = np.column_stack([rng.uniform(-0.35, 0.35, n), rng.uniform(-0.9, -0.4, n), rng.uniform(-np.pi, np.pi, n)])
    return Contact(poses, NID, GTERNAL, arena=ROBOTARIUM_FLOOR)


def publicly(world: Contact, command: np.ndarray) -> tuple[np.ndarray, list[int]]:
    """The same step by pymunk's public functions: states of all bodies, and whom each robot touches."""
    given, states, found = batch.Buffer(), batch.Buffer(), batch.Buffer()
    given.set_float_buf(command)
    batch.set_space_bodies(world.space, COMMAND, given)
    for _ in range(4):
        world.space.step(DT)
    batch.get_space_bodies(world.space, STATE, states)
    batch.get_space_arbiters(world.space, batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID, found)
    n = len(world.poses)
    row = {body.id: row for row, body in enumerate(list(world.space.bodies)[:n])}
    pairs = np.array([row.get(body, n) for body in memoryview(found.int_buf()).cast("P")], dtype=int).reshape(-1, 2)
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    touched = [min(pairs[pairs[:, 0] == one, 1].tolist(), default=NOTHING) for one in range(n)]
    return np.frombuffer(states.float_buf()).reshape(-1, 6).copy(), touched


def test_bodies_are_known_before_the_first_step() -> None:
    world = crowd(0, 12)
    known, touched = world.bodies.state.copy(), world.bodies.touched.copy()
    assert (np.ptp(known[:12, :2], axis=0) > 0.1).all()
    chipmunk.observe(world.bodies)
    np.testing.assert_array_equal(world.bodies.state, known)
    np.testing.assert_array_equal(world.bodies.touched, touched)


@pytest.mark.parametrize("seed", range(4))
def test_compiled_steps_are_those_of_the_public_way_bit_for_bit(seed: int) -> None:
    ours, theirs = crowd(seed, 12), crowd(seed, 12)
    rng, touches = np.random.default_rng(seed), 0
    for _ in range(60):
        command = rng.uniform(-0.3, 0.3, ours.bodies.command.shape)
        command[-1] = 0.0
        command[:12] = ours.bodies.state[:12, 3:]
        ours.bodies.command[:] = command
        chipmunk.drive(ours.bodies, 4, DT)
        states, touched = publicly(theirs, command)
        assert (ours.bodies.state[: len(states)] == states).all()
        assert ours.bodies.touched.tolist() == touched
        touches += sum(other != NOTHING for other in touched)
    assert touches > 100


def test_there_is_room_for_any_number_of_contacts() -> None:
    world = crowd(0, 80)
    chipmunk.drive(world.bodies, 1, DT)
    assert world.bodies.touch_count[0] > 200
    assert (world.bodies.touched != NOTHING).all()


@pytest.mark.parametrize("name", ["cpSpaceEachCachedArbiter", "pmIntArrayNew"])
def test_a_pymunk_that_lacks_a_function_is_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    world = crowd(0, 2)
    monkeypatch.setattr(chipmunk, "FUNCTIONS", (*chipmunk.FUNCTIONS, f"{name}OfLater"))
    with pytest.raises(ImportError, match=f"pymunk {pymunk.version} has no function {name}OfLater: expected 7.1 to"):
        chipmunk.bodies_of(world.space, list(world.space.bodies)[:2])
