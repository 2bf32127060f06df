"""The compiled kernel in every state that numbers can describe: it answers within the wheels' limits, always."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism
from robots.compiled import compiled
from robots.obstacles import Obstacle, disc
from robots.safety import FilterSettings, Noise, make_filter, solver
from robots.safety.step import bounded
from robots.senses.noise import draw_key

NID = NearIdentityDiffeomorphism(0.025)
PERIOD = 0.033
HUGE = 1.7e308
CLUTTER = (
    disc((0.2, 0.0), 0.05),
    Obstacle(np.array([[0.0, -0.5], [0.0, 0.5]]), 0.01),
    Obstacle(np.array([[-0.2, -0.2], [0.1, -0.2], [0.0, 0.1]])),
)

finite = st.floats(allow_nan=False, allow_infinity=False)
odd = st.one_of(
    st.sampled_from([0.0, -0.0, 5e-324, 1e-300, -1e-160, 0.155, 0.2, 0.3, -1.0, 1.0, 1e6, -1e155, HUGE, -HUGE]),
    st.floats(-0.4, 0.4),
    finite,
)
vectors = st.lists(st.tuples(odd, odd), min_size=3, max_size=3).map(np.array)
angles = st.lists(st.floats(-7.0, 7.0), min_size=3, max_size=3).map(np.array)


@compiled
def shortened(x: float, y: float) -> tuple[float, float]:
    return bounded(x, y)


def answer(
    name: str, points: np.ndarray, theta: np.ndarray, g: np.ndarray, v_r: np.ndarray, noise: Noise | None = None
) -> np.ndarray:
    arena = Arena((-1.0, 1.0), (-1.0, 1.0), True, CLUTTER)
    safety = make_filter(name, (len(points),), GTERNAL.drive, NID, FilterSettings(), arena)
    headings = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    u = safety.filter(points, headings, g, v_r, PERIOD, noise)
    assert np.isfinite(safety.intervention).all()
    assert np.isfinite(safety.relaxation).all()
    return u


@settings(max_examples=300)
@given(points=vectors, theta=angles, g=vectors, v_r=vectors)
@example(np.zeros((3, 2)), np.zeros(3), np.zeros((3, 2)), np.full((3, 2), 0.25))
@example(np.full((3, 2), HUGE), np.zeros(3), np.full((3, 2), HUGE), np.full((3, 2), -HUGE))
@example(np.array([[0.0, 0.0], [5e-324, 0.0], [0.0, 1e-300]]), np.ones(3), np.zeros((3, 2)), np.zeros((3, 2)))
@example(np.array([[0.0, -0.2], [-0.2, -0.2], [0.25, 0.0]]), np.ones(3), np.ones((3, 2)), np.zeros((3, 2)))
def test_every_finite_state_gets_a_command_within_the_wheels_limits(
    points: np.ndarray, theta: np.ndarray, g: np.ndarray, v_r: np.ndarray
) -> None:
    u = answer("decentralised", points, theta, g, v_r)
    assert np.abs(GTERNAL.drive.wheel_speeds(NID.twist(u))).max() <= GTERNAL.drive.wheel_speed_limit


@given(points=vectors, theta=angles, g=vectors, v_r=vectors, seed=st.integers(0, 2**32 - 1))
def test_every_finite_measurement_gets_a_finite_command(
    points: np.ndarray, theta: np.ndarray, g: np.ndarray, v_r: np.ndarray, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    noise = Noise(np.array(draw_key(rng)), float(rng.choice([0.0, 0.1, 1e9])), 2.0)
    assert np.isfinite(answer("decentralised", points, theta, g, v_r, noise)).all()


@pytest.mark.parametrize("side", [1.0, -1.0])
@given(direction=st.floats(-np.pi, np.pi), size=st.floats(1.001, 1e6))
def test_with_a_common_velocity_beyond_the_wheels_the_law_is_left_out(
    side: float, direction: float, size: float
) -> None:
    limit, weight = 0.2, 2.2
    edge = limit / (abs(np.cos(direction)) + weight * abs(np.sin(direction)))
    vx, vy = size * edge * np.cos(direction), size * edge * np.sin(direction)
    assert solver.within_wheels(vx, vy, 0.0, 0.0, limit, weight) == 0.0
    assert solver.within_wheels(vx, vy, vx, vy, limit, weight) == 0.0
    back = solver.within_wheels(vx, vy, -vx, -vy, limit, weight)
    assert back == 1.0  # v + g is at rest


@given(x=st.floats(-0.2, 0.2), share=st.floats(-1.0, 1.0), gx=odd, gy=odd)
def test_the_law_is_scaled_onto_the_diamond_and_no_further_than_it_must(
    x: float, share: float, gx: float, gy: float
) -> None:
    limit, weight = 0.2, 2.2
    y = share * (limit - abs(x)) / weight * 0.99
    gx, gy = shortened(gx, gy)
    s = solver.within_wheels(x, y, gx, gy, limit, weight)
    assert 0.0 <= s <= 1.0
    reached = abs(x + s * gx) + weight * abs(y + s * gy)
    assert reached <= limit + 1e-9
    assert s == 1.0 or reached >= limit - 1e-9


@given(x=finite, y=finite)
def test_a_velocity_is_shortened_to_a_million_metres_per_second_without_turning(x: float, y: float) -> None:
    bx, by = shortened(x, y)
    largest = max(abs(x), abs(y))
    if largest <= 1e6:
        assert (bx, by) == (x, y)
    else:
        assert max(abs(bx), abs(by)) == pytest.approx(1e6, rel=1e-15)
        np.testing.assert_allclose([bx, by], np.array([x, y]) / largest * 1e6, rtol=1e-15, atol=1e-300)


@given(
    points=st.lists(st.tuples(*[st.floats(-0.4, 0.4)] * 2), min_size=3, max_size=3).map(np.array),
    together=st.booleans(),
)
@pytest.mark.parametrize("name", ["centralised", "robotarium"])
def test_the_joint_filters_answer_robots_in_one_place_and_a_law_at_rest(
    name: str, points: np.ndarray, together: bool
) -> None:
    if together:
        points[1] = points[0]
    still = np.zeros((3, 2))
    assert np.isfinite(answer(name, points, np.zeros(3), still, still)).all()
    beyond = np.full((3, 2), 0.3)
    assert np.isfinite(answer(name, points, np.zeros(3), still, beyond)).all()
