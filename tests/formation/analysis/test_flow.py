"""Many runs at once end where their equations lead them: steps that the error allows, rest, horizon, flight."""

from collections.abc import Callable

import numpy as np
import pytest

from formation.analysis.flow import Flow, flow

Velocity = Callable[[np.ndarray, np.ndarray], np.ndarray]


def never(points: np.ndarray) -> np.ndarray:
    return np.zeros(len(points), dtype=bool)


def along(speed: Callable[[np.ndarray], np.ndarray], times: list[np.ndarray]) -> Velocity:
    """Agent 1 is a clock, agent 2 has a speed that the clock tells; ``times`` gets the clock's time of each call."""

    def velocity(points: np.ndarray, runs: np.ndarray) -> np.ndarray:
        t = points[:, 0, 0]
        times.append(t.copy())
        return np.stack([np.stack([np.ones_like(t), 0.0 * t], 1), np.stack([speed(t), 0.0 * t], 1)], axis=1)

    return velocity


def steps(times: list[np.ndarray]) -> list[float]:
    """The lengths of the steps, from the times at which the one run of a flow was asked: 1 at first, 3 in each step."""
    begins = [float(times[3 * k][0]) for k in range(len(times) // 3 + 1)]
    for k in range(len(begins) - 1):
        h = begins[k + 1] - begins[k]
        stages = [float(times[3 * k + s][0]) - begins[k] for s in (1, 2)]
        np.testing.assert_allclose(stages, [h / 2.0, 0.75 * h], atol=1e-12)
    return np.diff(begins).tolist()


START = np.zeros((1, 2, 2))


@pytest.mark.parametrize("speed", [np.ones_like, lambda t: t])
def test_where_a_second_order_step_is_exact_steps_grow_fourfold_to_the_largest(
    speed: Callable[[np.ndarray], np.ndarray],
) -> None:
    times: list[np.ndarray] = []
    found = flow(along(speed, times), START, 4.0, never)
    np.testing.assert_allclose(steps(times), [0.002, 0.008, 0.032, 0.128, 0.512, 1.0, 1.0, 1.0, 0.318])
    assert found.time.tolist() == [4.0]


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_where_the_third_derivative_is_constant_steps_are_nine_tenths_of_what_the_error_allows(
    tolerance: float,
) -> None:
    """With a speed of t^2 the two solutions differ by h^3 / 24 in a step."""
    times: list[np.ndarray] = []
    found = flow(along(np.square, times), START, 1.0, never, tolerance)
    allowed = 0.9 * np.cbrt(24.0 * tolerance)
    lengths = steps(times)
    early = [h for h in (0.002, 0.008, 0.032) if h < allowed]
    np.testing.assert_allclose(lengths[: len(early)], early)
    np.testing.assert_allclose(lengths[len(early) : -1], allowed)
    assert found.points[0, 1, 0] == pytest.approx(1.0 / 3.0, abs=1e-12)  # the third-order solution is taken


def test_a_step_whose_error_is_too_large_is_taken_again_by_a_fifth_at_least() -> None:
    times: list[np.ndarray] = []
    found = flow(along(lambda t: 1e6 * np.maximum(t - 2.0, 0.0) ** 2, times), START, 2.1, never, 1e-4)
    assert found.points[0, 1, 0] == pytest.approx(1e6 * 0.1**3 / 3.0, abs=0.01)
    ends = np.array([float(t[0]) for t in times[3::3]])
    first = int(np.flatnonzero(np.diff(ends) < 0.0)[0])
    begin = ends[first - 1]
    assert ends[first + 1] - begin == pytest.approx(0.2 * (ends[first] - begin))


def test_a_step_is_never_smaller_than_the_smallest_whatever_the_error() -> None:
    times: list[np.ndarray] = []
    flow(along(np.square, times), START, 0.5, never, 1e-15, smallest=0.05)
    np.testing.assert_allclose(steps(times), [0.05] * 10)


def test_each_run_has_its_own_equation_and_rests_by_itself() -> None:
    rates = np.array([0.5, 2.0, 8.0])
    start = np.tile([[[1.0, 0.0], [0.0, -1.0]]], (3, 1, 1))
    asked: list[np.ndarray] = []

    def velocity(points: np.ndarray, runs: np.ndarray) -> np.ndarray:
        asked.append(runs)
        return -rates[runs, None, None] * points

    found = flow(velocity, start, 100.0, lambda p: np.abs(p).max(axis=(1, 2)) < 0.1, rest=1e-3)
    assert (found.speed < 1e-3).all()
    np.testing.assert_allclose(found.velocity, -rates[:, None, None] * found.points)
    np.testing.assert_allclose(found.points, start * np.exp(-rates * found.time)[:, None, None], atol=1e-5)
    early = np.log(rates / 1e-3) / rates
    assert (found.time >= early - 1e-3).all()
    assert (found.time < early + np.minimum(2.6 / rates, 1.0)).all()
    last = np.log(10.0) / rates  # when each comes within 0.1
    assert (found.settled <= last + 1e-4).all()
    assert (found.settled > last - 0.3 / rates).all()
    assert asked[0].tolist() == [0, 1, 2]
    assert asked[-1].size == 1
    assert not found.diverged.any()


def test_a_run_that_does_not_rest_ends_at_the_horizon_and_one_that_leaves_the_goal_has_not_settled() -> None:
    velocity: list[float] = [0.0, 1.0, -1.0]

    def near(points: np.ndarray) -> np.ndarray:
        return np.abs(points[:, 0, 0]) < 1.0

    def moves(points: np.ndarray, runs: np.ndarray) -> np.ndarray:
        u = np.zeros_like(points)
        u[:, 0, 0] = np.array(velocity)[runs]
        return u

    start = np.zeros((3, 1, 2))
    start[2, 0, 0] = 2.5
    found = flow(moves, start, 3.0, near)
    assert found.time[0] < 0.01
    assert found.time[1:].tolist() == [3.0, 3.0]
    assert found.settled[0] == 0.0
    assert found.settled[1] == np.inf
    assert 0.5 < found.settled[2] <= 1.5


@pytest.mark.parametrize("rate", [1.0, np.nan])
def test_a_run_that_leaves_for_infinity_or_gives_no_number_is_given_up(rate: float) -> None:
    found = flow(lambda p, _: rate * p, np.ones((1, 1, 2)), 50.0, never, 1e-3)
    assert found.diverged.tolist() == [True]
    if np.isfinite(rate):
        assert np.log(1e4) <= found.time[0] < np.log(1e4) + 0.1
        assert 1e4 <= np.abs(found.points).max() < 1.2e4
    else:
        assert found.time[0] < 0.01


def test_progress_is_the_time_of_the_run_that_is_furthest_back_and_1_in_the_end() -> None:
    told: list[float] = []
    rates = np.array([0.0, 1.0])

    def velocity(points: np.ndarray, runs: np.ndarray) -> np.ndarray:
        return np.ones_like(points) * rates[runs, None, None]

    flow(velocity, np.zeros((2, 1, 2)), 4.0, never, rest=1e-9, on_progress=told.append)
    assert told == sorted(told)
    np.testing.assert_allclose(told, [0.0005, 0.0025, 0.0105, 0.0425, 0.1705, 0.4205, 0.6705, 0.9205, 1.0])
    flow(velocity, np.zeros((1, 1, 2)), 0.0, never, on_progress=told.append)
    assert told[-1] == 1.0


def test_the_speed_is_that_of_the_fastest_agent_and_the_drift_that_of_the_centre() -> None:
    velocity = np.array([[[3.0, 4.0], [-1.0, 0.0]], [[0.0, 1.0], [0.0, 1.0]]])
    found = Flow(np.zeros((2, 2, 2)), velocity, np.zeros(2), np.zeros(2))
    np.testing.assert_allclose(found.speed, [5.0, 1.0])
    np.testing.assert_allclose(found.drift, [np.hypot(1.0, 2.0), 1.0])


def test_unless_it_is_told_otherwise_a_flow_errs_by_1e_7_in_a_step_and_rests_at_1e_5() -> None:
    plain, told = (
        flow(lambda p, _: -p, np.ones((1, 1, 2)), 100.0, never, **given)
        for given in ({}, {"tolerance": 1e-7, "smallest": 2e-3, "rest": 1e-5})  # type: ignore[arg-type]
    )
    assert plain.time == told.time
    times: list[np.ndarray] = []
    flow(along(np.ones_like, times), START, 1.0, never, smallest=1e-4)
    np.testing.assert_allclose(steps(times)[:3], [1e-3, 4e-3, 1.6e-2])


def test_a_run_diverges_in_either_direction_and_alone() -> None:
    points = np.zeros((3, 4, 2))
    points[0, 3, 1], points[1, 0, 0], points[2, 1, 1] = -1e4, 9999.0, np.nan
    assert Flow(points, points, np.zeros(3), np.zeros(3)).diverged.tolist() == [True, False, True]
