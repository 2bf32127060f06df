"""References: their derivatives, and the feed-forward that makes the angle law exact on them."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from formation import AngleLaw, SensingGraph, TargetFormation
from formation.analysis.lags import turning_gains
from formation.laws.feedforward import FeedForward, places
from formation.plane import as_complex, as_vectors
from formation.references.curves import CURVES, ClosedCurve, curve_length
from formation.references.lag import Settled, shape_residual
from formation.references.protocol import Reference, pair_displacement
from formation.references.ramps import Ramps
from formation.references.way_points import WayPoints

STEP = 1e-5
TARGET = TargetFormation(
    SensingGraph(np.array([[0, 1], [1, 2], [0, 3], [0, 3]])),
    np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.5, -0.5), (-0.5, 1.5)]),
)
WAY = WayPoints(
    np.array([0.0, 7.0, 15.0, 20.0]),
    np.array([0.0, 1.0, 1.0 + 1.0j, 2.0j]),
    np.array([1.0, 0.6, 0.6, 1.4]),
    np.array([0.0, 0.5, -1.0, 7.0]),
)

curves = st.builds(
    ClosedCurve,
    st.sampled_from(sorted(CURVES)),
    st.tuples(st.floats(0.2, 2.0), st.floats(0.2, 2.0)),
    st.floats(10.0, 100.0),
    st.floats(-4.0, 4.0),
    st.booleans(),
    st.booleans(),
)
RAMPS = Ramps(
    np.array([0.0, 4.0, 11.0]),
    np.array([0.0, 0.1 + 0.05j, -0.1j]),
    np.array([2.0, 1.0, 3.0]),
    np.array([0.5, 0.5, -1.0]),
)


@given(curves | st.just(WAY) | st.just(RAMPS), st.floats(0.1, 19.9))
def test_velocity_and_rate_are_the_derivatives_of_path_and_factor(reference: Reference, t: float) -> None:
    assume((np.abs(reference.bends - t) > STEP).all())
    ends = np.array([t - STEP, t + STEP])
    velocity = np.diff(reference.path(ends))[0] / (2.0 * STEP)
    rate = np.diff(np.log(reference.factor(ends) / reference.factor(t)))[0] / (2.0 * STEP)
    assert abs(velocity - reference.velocity(t)) < 1e-6
    assert abs(rate - reference.rate(t)) < 1e-6
    assert reference.path(0.0) == 0.0
    assert abs(reference.factor(0.0) - 1.0) < 1e-15


@given(curves, st.floats(0.0, 50.0))
def test_a_closed_curve_repeats_after_one_round(reference: ClosedCurve, t: float) -> None:
    for what in (reference.path, reference.velocity, reference.factor, reference.rate):
        assert abs(what(t) - what(t + reference.period)) < 1e-9


@given(curves, st.floats(0.0, 50.0))
def test_a_formation_that_turns_with_the_path_keeps_the_velocity_in_one_direction_of_its_own(
    curve: ClosedCurve, t: float
) -> None:
    if curve.turning:
        seen = curve.velocity(np.array([0.0, t])) / curve.factor(np.array([0.0, t]))
        assert abs(np.angle(seen[1] / seen[0])) < 1e-9


def test_way_points_are_passed_at_their_times_and_both_ends_are_at_rest() -> None:
    times = np.array([0.0, 7.0, 15.0, 20.0])
    np.testing.assert_allclose(WAY.path(times), [0.0, 1.0, 1.0 + 1.0j, 2.0j], atol=1e-14)
    np.testing.assert_allclose(np.abs(WAY.factor(times)), [1.0, 0.6, 0.6, 1.4], atol=1e-14)
    still = np.array([0.0, 20.0, 30.0])
    assert np.abs([WAY.velocity(still), WAY.rate(still)]).max() < 1e-14
    assert WAY.path(30.0) == WAY.path(20.0)


def test_way_points_that_arrive_moving_stop_at_the_last_all_at_once() -> None:
    times = np.array([0.0, 3.0, 7.0, 10.0])
    way = WayPoints(times, times * (0.1 + 0.2j), 1.0 + 0.1 * times, 0.05 * times, moving=True)
    assert way.bends.tolist() == [10.0]
    assert abs(way.velocity(9.999) - (0.1 + 0.2j)) < 1e-12
    assert abs(way.velocity(0.0) - (0.1 + 0.2j)) < 1e-12
    assert abs(way.rate(9.999)) > 0.05
    assert np.abs([way.velocity(10.0), way.rate(10.0), way.velocity(12.0), way.rate(12.0)]).max() == 0.0
    assert WAY.bends.size == 0
    with pytest.raises(ValueError, match="scales must be positive"):
        WayPoints(times, times + 0j, np.array([1.0, 2.0, 0.0, 1.0]), times)


def test_way_points_are_twice_continuously_differentiable() -> None:
    for knot in (7.0, 15.0):
        sides = np.array([knot - 2e-4, knot - 1e-4, knot + 1e-4, knot + 2e-4])
        for what in (WAY.velocity, WAY.rate):
            bends = np.diff(what(sides))[[0, 2]] / 1e-4
            assert abs(bends[0] - bends[1]) < 1e-3


@pytest.mark.parametrize("times", [[0.0], [1.0, 2.0], [0.0, 2.0, 2.0]])
def test_times_that_do_not_begin_at_0_or_do_not_increase_are_refused(times: list[float]) -> None:
    one = np.ones(len(times))
    with pytest.raises(ValueError, match="times must begin with 0 and increase"):
        WayPoints(np.array(times), one + 0j, one, one)


def test_the_length_of_a_circle_is_pi_times_its_width() -> None:
    assert curve_length("circle", (0.8, 0.8)) == pytest.approx(0.8 * np.pi, rel=1e-13)


@given(st.floats(-0.5, 0.5), st.floats(-0.05, 0.05), st.floats(-3.0, 3.0), st.floats(0.2, 2.0), st.floats(-9.0, 9.0))
def test_in_the_shape_law_and_feed_forward_give_each_agent_the_velocity_of_its_place(
    omega: float, sigma: float, angle: float, size: float, frame: float
) -> None:
    mu, delta = complex(sigma, omega), size * np.exp(1j * angle)
    p, turn = places(TARGET) * delta, np.exp(-1j * frame)
    k, i = TARGET.graph.edges.T
    relative = as_vectors((p[i] - p[k]) * turn)
    u = as_complex(AngleLaw(TARGET)(relative) + FeedForward(TARGET)(relative, mu))
    np.testing.assert_allclose(u, places(TARGET) * mu * delta * turn, atol=1e-12)


@pytest.mark.parametrize("omega", [0.1, 0.2, 0.5])
def test_on_a_circle_the_settled_lag_is_the_gain_of_the_cascade(omega: float) -> None:
    y = Settled(TARGET, ClosedCurve("circle", (0.6, 0.6), 2.0 * np.pi / omega), False)()
    t = np.arange(len(y)) * (2.0 * np.pi / omega / len(y))
    np.testing.assert_allclose(y, np.exp(1j * omega * t)[:, None] * turning_gains(TARGET, omega), atol=1e-12)


def test_with_feed_forward_and_continuous_commands_nothing_lags() -> None:
    curve = ClosedCurve("figure-eight", (1.0, 0.5), 40.0)
    y = Settled(TARGET, curve, True)()
    assert shape_residual(TARGET, y).max() < 1e-12


def test_the_residual_of_a_shape_is_blind_to_scale_place_and_turn() -> None:
    shape = places(TARGET)
    off = shape + np.array([0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    assert shape_residual(TARGET, 3.0j * shape + 2.0) < 1e-15
    assert shape_residual(TARGET, 3.0j * off + 2.0) == pytest.approx(float(shape_residual(TARGET, off)))
    assert shape_residual(TARGET, off) > 0.01


@pytest.mark.parametrize(
    ("law", "told", "size", "turn"),
    [
        ("stationary", False, 0.5, 0.2), ("stationary", True, 0.25, 1.2), ("displacement", False, 1.0, 1.7),
        ("distance", False, 1.0, 0.2), ("distance", True, 1.0, 1.2), ("bearing", False, 0.5, 1.7),
        ("bearing", True, 0.25, 1.7),
    ],
)  # fmt: skip
def test_what_a_first_follower_does_not_steer_stays_or_is_fed_forward(
    law: str, told: bool, size: float, turn: float
) -> None:
    way = WayPoints(np.array([0.0, 9.0]), np.zeros(2) + 0j, np.array([2.0, 1.0]), np.array([0.0, 1.0]))
    e = pair_displacement(way, 0.5 * np.exp(0.2j), 2.0 * np.exp(0.7j), law, told, 9.0)
    assert abs(e - size * np.exp(1j * turn)) < 1e-12


def test_ramps_pass_the_velocities_they_are_told_on_straight_lines_and_keep_the_last() -> None:
    told = np.array([0.0, 0.1, 0.1 + 0.05j, 0.02j])
    ramps = Ramps(np.array([0.0, 2.0, 5.0, 6.0]), told)
    np.testing.assert_allclose(ramps.velocity(np.array([0.0, 2.0, 5.0, 6.0, 9.0])), [*told, told[-1]])
    np.testing.assert_allclose(ramps.velocity(1.0), 0.05)
    t = np.linspace(0.0, 9.0, 9001)
    summed = np.concatenate([[0.0], np.cumsum((ramps.velocity(t)[1:] + ramps.velocity(t)[:-1]) / 2.0 * np.diff(t))])
    np.testing.assert_allclose(ramps.path(t), summed, atol=1e-12)
    assert (ramps.factor(t) == 1.0).all()
    assert (ramps.rate(t) == 0.0).all()


def test_scale_and_turn_of_ramps_are_straight_lines_between_their_times_and_stay_after_the_last() -> None:
    t = np.array([0.0, 2.0, 4.0, 7.5, 11.0, 20.0])
    np.testing.assert_allclose(np.abs(RAMPS.factor(t)), [1.0, 0.75, 0.5, 1.0, 1.5, 1.5])
    np.testing.assert_allclose(np.angle(RAMPS.factor(t)), [0.0, 0.0, 0.0, -0.75, -1.5, -1.5], atol=1e-15)
    assert RAMPS.rate(11.0) == 0.0
    assert RAMPS.rate(4.0) == pytest.approx(2.0 / 7.0 - 1.5j / 7.0)
    assert RAMPS.bends.tolist() == [4.0, 11.0]


def test_ramps_do_not_scale_through_nothing() -> None:
    with pytest.raises(ValueError, match="scales must be positive"):
        Ramps(np.array([0.0, 1.0]), np.zeros(2, dtype=complex), np.array([1.0, 0.0]))


@pytest.mark.parametrize("times", [[0.0], [1.0, 2.0], [0.0, 2.0, 2.0]])
def test_ramps_begin_at_0_and_go_forward(times: list[float]) -> None:
    with pytest.raises(ValueError, match="times must begin with 0 and increase"):
        Ramps(np.array(times), np.zeros(len(times), dtype=complex))
