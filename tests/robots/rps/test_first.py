"""Controllers and mappings of the first generation, and of 2018, by their formulas."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robots.rps.version1 import controllers, transformations

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed: int) -> tuple[np.ndarray, np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-0.05, 0.05, (3, 5)) * [[1.0], [1.0], [40.0]], rng.uniform(-0.05, 0.05, (3, 5)), rng


def steered(wish: complex, theta: float, gain: float, limit: float) -> tuple[float, float]:
    """Along the heading, and a turn by the angle to the wish."""
    seen = wish * np.exp(-1j * theta)
    speed = gain * seen.real
    return speed, limit * np.arctan2(seen.imag, speed) / (np.pi / 2.0)


def shortened(wish: complex, limit: float) -> complex:
    return wish * min(1.0, limit / abs(wish))


@given(seed=SEEDS, approached=st.booleans())
def test_the_hybrid_controller_drives_beyond_its_error_and_turns_within(seed: int, approached: bool) -> None:
    x, goals, rng = drawn(seed)
    told = (rng.random(5) < 0.5).astype(float) if approached else None
    make = controllers.create_hybrid_unicycle_pose_controller
    found = make(0.9, 1.7, 0.03, 2.0, 0.06, 0.02, 0.1)(x, goals, told)
    for robot in range(5):
        way = complex(*(goals[:2, robot] - x[:2, robot]))
        turn = np.angle(np.exp(1j * (goals[2, robot] - x[2, robot])))
        if abs(way) > 0.06 - 0.02 and (told is None or told[robot]):
            expected = steered(shortened(way, 0.03), x[2, robot], 0.9, 2.0)
        else:
            expected = (0.0, 1.7 * turn if abs(turn) > 0.1 else 0.0)
        np.testing.assert_allclose(found[:, robot], expected, atol=1e-12)


@given(seed=SEEDS)
def test_in_2018_robots_drive_to_a_centimetre_and_turn_there(seed: int) -> None:
    x, goals, _ = drawn(seed)
    goals[:2, 0] = x[:2, 0] + [0.006, -0.006]
    found = controllers.unicycle_pose_controller(x, goals)
    points = controllers.single_integrator_position_controller(x[:2], goals[:2], 2.0, 0.05)
    for robot in range(5):
        way = complex(*(goals[:2, robot] - x[:2, robot]))
        turn = np.angle(np.exp(1j * (goals[2, robot] - x[2, robot])))
        v, omega = steered(shortened(way, 0.08), x[2, robot], 1.0, np.pi)
        expected = (0.0, turn) if abs(way) <= 0.01 else (v, (np.pi / 2.0) ** 2 * omega)
        np.testing.assert_allclose(found[:, robot], expected, atol=1e-12)
        wish = shortened(2.0 * way, 0.05)
        np.testing.assert_allclose(points[:, robot], [wish.real, wish.imag])


@given(seed=SEEDS)
def test_mappings_at_once_are_those_that_are_made(seed: int) -> None:
    x, wish, rng = drawn(seed)
    wish = wish[:2]
    commands = rng.normal(size=(2, 5))
    at_once = transformations.single_integrator_to_unicycle2(wish, x, 0.7, 2.0)
    exact, points = transformations.create_single_integrator_to_unicycle(0.04)
    cut, same = transformations.create_si_to_uni_mapping(0.04, 0.5)
    back = transformations.unicycle_to_single_integrator(commands, x, 0.04)
    made = transformations.create_uni_to_si_dynamics(0.04)(commands, x)
    for robot in range(5):
        heading = np.exp(1j * x[2, robot])
        v, omega = steered(complex(*wish[:, robot]), x[2, robot], 0.7, 2.0)
        np.testing.assert_allclose(at_once[:, robot], [v, (np.pi / 2.0) ** 2 * omega])
        seen = complex(*wish[:, robot]) / heading
        np.testing.assert_allclose(exact(wish, x)[:, robot], [seen.real, seen.imag / 0.04])
        np.testing.assert_allclose(cut(wish, x)[:, robot], [seen.real, np.clip(seen.imag / 0.04, -0.5, 0.5)])
        ahead = complex(*x[:2, robot]) + 0.04 * heading
        np.testing.assert_allclose(points(x)[:, robot], [ahead.real, ahead.imag])
        np.testing.assert_allclose(same(x)[:, robot], [ahead.real, ahead.imag])
        moved = complex(commands[0, robot], 0.04 * commands[1, robot]) * heading
        np.testing.assert_allclose(back[:, robot], [moved.real, moved.imag])
        np.testing.assert_allclose(made[:, robot], [moved.real, moved.imag])
    turning = transformations.create_si_to_uni_dynamics_with_backwards_motion(0.7, 2.0)(wish, x)
    np.testing.assert_array_equal(turning, transformations.create_si_to_uni_dynamics(0.7, 2.0)(wish, x))
