"""What the identification computes: whitened logs, likelihoods, ways of wheels, beside dense and plain forms."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from robots.identification import check, synthetic
from robots.identification.check import checked
from robots.identification.design import COLUMNS, linearised
from robots.identification.innovations import whiten
from robots.identification.likelihood import Likelihood
from robots.identification.log import Log
from robots.identification.numbers import NAMES, TURN, normal
from robots.identification.odometry import RADIANS_PER_COUNT, chords, filled, odometry, reference
from robots.identification.reckoning import dead_reckoning
from robots.identification.synthetic import FINE, Way, random_truth, random_way, synthesise, way_of
from robots.measured import MEASURED

SILENT = replace(
    MEASURED.numbers,
    **dict.fromkeys(
        ("jitter", "position_noise", "heading_noise", "slip_along", "slip_heading", "slip_turning", "missing", "stale"),
        0.0,
    ),
)


def test_a_log_is_whitened_by_the_root_of_its_covariance(plain: Callable[[Any], Any]) -> None:
    """Of all poses together: what a Cholesky factor does to them at once, the filter does one after the other."""
    rng, turns = np.random.default_rng(0), 7
    columns = rng.normal(size=(turns, 3, 2))
    step, speed, slip = rng.normal(size=(turns, 2)), rng.normal(size=(turns, 3)), rng.uniform(0.1, 1.0, (turns, 3))
    known, noise = np.array([1, 1, 0, 1, 1, 0, 1], dtype=bool), np.array([0.3, 0.2, 0.5])
    jitter, memory = 0.7, 0.6
    white, variance = plain(whiten)(columns, step, speed, known, slip, noise, jitter, memory)

    sources = 4 + 4 * turns + 3 * turns
    state = np.zeros((4, sources))
    state[:3, :3], state[3, 3] = np.eye(3) * np.sqrt(1e-2), np.sqrt(jitter)
    seen = []
    for k in range(turns):
        if k:
            onward = np.eye(4)
            onward[0, 2], onward[1, 2], onward[3, 3] = -step[k, 1], step[k, 0], memory
            state = onward @ state
            own = 4 + 4 * k
            state[:3, own : own + 3] += np.diag(np.sqrt(slip[k]))
            state[3, own + 3] += np.sqrt(jitter * (1.0 - memory**2))
        if known[k]:
            pose = state[:3] + speed[k][:, None] * state[3]
            pose[:, 4 + 4 * turns + 3 * k :][:, :3] += np.diag(np.sqrt(noise))
            seen.append(pose)
    root = np.linalg.cholesky(np.concatenate(seen) @ np.concatenate(seen).T)
    np.testing.assert_allclose(variance[known].ravel(), np.diagonal(root) ** 2)
    expected = np.linalg.solve(root, columns[known].reshape(-1, 2))
    np.testing.assert_allclose(white[known].reshape(-1, 2), expected)
    assert not white[~known].any()
    assert (variance[~known] == 1.0).all()


@pytest.fixture(scope="module")
def log() -> Log:
    rng = np.random.default_rng(3)
    return checked(*synthesise(random_way(rng, 500), MEASURED.numbers, rng))


def test_the_slope_of_the_likelihood_is_its_derivative_and_its_value_that_of_normal_noise(log: Log) -> None:
    likelihood = Likelihood(linearised(log, 0.72, 0.016, 0.15), log.heading_quantum)
    noises = np.array([*np.log([6e-5, 6e-4, 3e-3, 9e-3, 2e-2, 0.3]), 0.4])
    slope, h = likelihood.slope(noises), 1e-4
    for i in range(len(noises)):
        move = h * np.eye(len(noises))[i]
        change = (likelihood.value(noises + move) - likelihood.value(noises - move)) / (2.0 * h)
        assert slope[i] == pytest.approx(change, rel=0.02, abs=0.5)
    white = likelihood.whitened(noises)
    expected = 0.5 * ((white.residuals**2).sum() + white.log_variance.sum() + np.linalg.slogdet(white.information)[1])
    assert likelihood.value(noises) == pytest.approx(expected)
    curvature = likelihood.curvature(noises)
    np.testing.assert_allclose(curvature, curvature.T)
    assert np.linalg.eigvalsh(curvature).min() > 0.0
    assert (likelihood.deviations(noises) >= np.sqrt(np.diag(np.linalg.inv(curvature))) * (1.0 - 1e-9)).all()


def quiet_log(turns: int = 400) -> tuple[Log, Way]:
    rng = np.random.default_rng(5)
    way = random_way(rng, turns)
    return checked(*synthesise(way, SILENT, rng)), way


def test_the_regressors_of_a_log_are_its_derivatives_by_the_numbers() -> None:
    """Of a silent robot the guess errs by the numbers' deviations times their columns, to first order."""
    log, _ = quiet_log()
    truth = SILENT.wheel_radius / SILENT.base_length
    design = linearised(log, SILENT.lag, SILENT.wheel_radius, truth)
    assert design.columns.shape == (log.turns, 3, 1 + len(COLUMNS))
    lever = [1 + COLUMNS.index(name) for name in ("offset_ahead", "offset_left")]
    assert not design.columns[0][:, lever].any()  # a point off the axle begins where the first pose is
    known = design.way.known
    values = {
        "wheel_radius": SILENT.wheel_radius, "per_turned": truth, "offset_ahead": SILENT.offset_ahead,
        "offset_left": SILENT.offset_left, "lag": 0.0, "drift": 0.0, "marker_angle": 0.0,
    }  # fmt: skip
    told = design.columns[..., 1:] @ np.array([values[name] for name in COLUMNS])
    left = design.columns[known, :, 0] - told[known]
    left = left - left[0]
    assert np.abs(left[:, :2]).max() < 0.01
    assert np.abs(left[:, 2]).max() < 5e-3
    np.testing.assert_allclose(design.driven, SILENT.wheel_radius * np.abs(np.diff(design.way.forward, prepend=0.0)))
    np.testing.assert_allclose(design.turned, truth * np.abs(np.diff(design.way.turned, prepend=0.0)))


def test_wheels_are_read_later_by_the_lag_and_lost_messages_are_spread() -> None:
    counts = np.cumsum(np.full((60, 2), [40.0, 60.0]), axis=0)
    counts[20] = counts[19]
    counts[40] = np.nan
    log = Log(np.cumsum(np.ones((60, 3)), axis=0), counts)
    way = odometry(log, 0.5)
    np.testing.assert_allclose(way.forward[1:59], RADIANS_PER_COUNT * 50.0 * np.arange(1, 59), atol=1e-9)
    np.testing.assert_allclose(way.turned[1:59], RADIANS_PER_COUNT * 20.0 * np.arange(1, 59), atol=1e-9)
    assert np.flatnonzero(~way.known).tolist() == [19, 20, 39, 40, 59]
    assert np.flatnonzero(~way.heard).tolist() == [59]
    assert log.seen.all()
    assert np.flatnonzero(~log.heard).tolist() == [20, 40]
    assert np.flatnonzero(~log.moving).tolist() == [0]


def test_a_robot_at_rest_hears_nothing_new_and_loses_nothing() -> None:
    counts = np.concatenate([np.zeros((30, 2)), np.cumsum(np.full((30, 2), [0.0, 50.0]), axis=0), np.full((9, 2), 0.0)])
    counts[60:] = counts[59]
    log = Log(np.zeros((69, 3)), counts)
    assert np.flatnonzero(log.heard).tolist() == [0, *range(30, 60)]
    assert not log.moving[60:].any()
    assert log.moving[31:59].all()
    assert log.seen.tolist() == [True] + [False] * 68
    assert log.turns == 69


def test_headings_are_held_to_the_cameras_and_chords_are_those_of_arcs() -> None:
    log, _ = quiet_log()
    way = odometry(log, SILENT.lag)
    theta = filled(log.poses)[:, 2]
    per_turned = SILENT.wheel_radius / SILENT.base_length
    held = reference(way, theta + 0.3, 1.01 * per_turned)
    for k in (0, 5, 50, log.turns - 1):
        around = slice(max(0, k - 10), k + 11)
        off = (theta + 0.3 - 1.01 * per_turned * way.turned)[around].mean()
        assert held[k] == pytest.approx(1.01 * per_turned * way.turned[k] + off)
    steps = chords(way, held)
    assert steps[0] == 0.0
    for k in (1, 40, 111):
        turn, length = held[k] - held[k - 1], way.forward[k] - way.forward[k - 1]
        middle = (np.arange(2000) + 0.5) / 2000.0
        assert steps[k] == pytest.approx((length * np.exp(1j * (held[k - 1] + middle * turn))).mean(), abs=1e-9)


def test_poses_that_are_missing_lie_between_their_neighbours() -> None:
    poses = np.array([[0.0, 1.0, 2.0], [np.nan] * 3, [4.0, 5.0, 0.0], [np.nan] * 3])
    np.testing.assert_allclose(filled(poses), [[0, 1, 2], [2, 3, 1], [4, 5, 0], [4, 5, 0]])


@pytest.mark.parametrize("spread", [True, False])
def test_reckoning_is_the_root_mean_square_over_all_windows_that_can_be_told(spread: bool) -> None:
    log, _ = quiet_log()
    found = dead_reckoning(log, 0.0161, 0.108, 1.0, 0.001 + 0.002j, 0.01, spread, 20)
    theta = log.poses[:, 2] - 0.01
    axle = log.poses[:, :2] @ (1.0, 1j) - (0.001 + 0.002j) * np.exp(1j * theta)
    angles = RADIANS_PER_COUNT * log.counts
    errors = []
    for begin in range(log.turns - 21):
        left, right = angles[begin + 1 : begin + 22].T
        heading = theta[begin] + 0.0161 / 0.108 * (right - left - (right - left)[0])
        length, turn = 0.0161 * np.diff(left + right) / 2.0, np.diff(heading)
        arcs = length * np.sinc(turn / (2.0 * np.pi)) * np.exp(1j * (heading[1:] + heading[:-1]) / 2.0)
        errors.append((abs(axle[begin + 20] - axle[begin] - arcs.sum()), theta[begin + 20] - heading[-1]))
    if spread:
        assert found.windows <= len(errors)
        assert found.windows > 0.9 * len(errors)
    else:
        assert found.windows == len(errors)
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    np.testing.assert_allclose([found.position, found.heading], rms, rtol=0.05 if spread else 1e-9)


def test_a_random_way_is_of_straights_spins_arcs_and_rests_within_what_robots_drive() -> None:
    way = random_way(np.random.default_rng(0), 20_000)
    assert len(way.forward) == len(way.turn) == 20_010 * FINE
    speed, spin = way.forward * FINE / TURN, way.turn * FINE / TURN
    assert 0.14 < np.abs(speed).max() <= 0.15
    assert 2.8 < np.abs(spin).max() <= 3.0
    straight, turning = np.abs(speed) > 0.02, np.abs(spin) > 0.1
    shares = [(straight & ~turning).mean(), (~straight & turning).mean(), (straight & turning).mean()]
    np.testing.assert_allclose(shares, [0.35, 0.3, 0.3], atol=0.05)
    assert (speed > 0.02).sum() > 1.5 * (speed < -0.02).sum()
    smooth = np.abs(np.diff(speed)).max()
    assert smooth < 0.3 / (3.0 * FINE)  # no jumps: a change takes some turns


def test_random_robots_lie_about_the_measured_one() -> None:
    draws = [random_truth(np.random.default_rng(seed)) for seed in range(300)]
    for name in NAMES:
        values = np.array([getattr(each, name) for each in draws])
        truth = getattr(MEASURED.numbers, name)
        assert values.min() * 0.9 <= truth <= values.max() * 1.1, name
    widths = np.array([[each.wheel_radius, each.base_length] for each in draws])
    assert (widths.std(axis=0) / widths.mean(axis=0) < 0.03).all()


def test_a_silent_robot_goes_its_way_and_counts_it() -> None:
    steps = 310 * FINE
    straight = Way(np.full(steps, 0.001), np.zeros(steps))
    poses, counts = synthesise(
        straight, replace(SILENT, offset_left=0.002, offset_ahead=0.003), np.random.default_rng(0)
    )
    assert poses.shape == (300, 3)
    np.testing.assert_allclose(np.diff(poses[:, 0]), 0.001 * FINE)
    np.testing.assert_allclose(poses[:, 1], 0.002, atol=1e-12)
    np.testing.assert_allclose(
        np.diff(counts, axis=0).mean(axis=0), 0.02 / SILENT.wheel_radius / RADIANS_PER_COUNT, rtol=1e-3
    )
    turned = Way(np.zeros(steps), np.full(steps, 0.01))
    poses, counts = synthesise(turned, SILENT, np.random.default_rng(0))
    np.testing.assert_allclose(np.diff(np.unwrap(poses[:, 2])), 0.01 * FINE, atol=1.1e-3)
    rate = 0.2 * SILENT.base_length / 2.0 / SILENT.wheel_radius / RADIANS_PER_COUNT
    np.testing.assert_allclose(np.diff(counts, axis=0).mean(axis=0), [-rate, rate], rtol=1e-3)


@pytest.mark.parametrize(
    ("name", "axis", "way"),
    [("slip_heading", 2, (0.001, 0.0)), ("slip_turning", 2, (0.0, 0.01)), ("slip_along", 1, (0.001, 0.0))],
)
def test_slip_is_a_random_walk_whose_deviation_grows_with_the_root_of_the_way(
    name: str, axis: int, way: tuple[float, float]
) -> None:
    steps = 2010 * FINE
    rng = np.random.default_rng(1)
    each = Way(np.full(steps, way[0]), np.full(steps, way[1]))
    poses, _ = synthesise(each, replace(SILENT, **{name: 0.05}, offset_ahead=0.0, offset_left=0.0), rng)
    gained = np.diff(np.unwrap(poses[:, 2]) if axis == 2 else poses[:, 1])
    deviation = 0.05 * np.sqrt(FINE * max(way))
    assert gained.std() == pytest.approx(deviation, rel=0.08)


def test_a_share_of_messages_is_lost_and_the_one_before_stands_in_its_place() -> None:
    rng = np.random.default_rng(2)
    values = np.arange(4000.0)[:, None] + [0.0, 0.5]
    found = synthetic._repeated(values, 0.3, rng)
    kept = (found == values).all(axis=1)
    assert kept[0]
    assert kept.mean() == pytest.approx(0.7, abs=0.03)
    np.testing.assert_array_equal(found[1:][~kept[1:]], found[:-1][~kept[1:]])
    assert (synthetic._repeated(values, 0.0, rng) == values).all()


def test_the_jitter_has_its_deviation_and_its_memory() -> None:
    truth = replace(MEASURED.numbers, jitter=0.3, jitter_memory=0.6)
    drawn = synthetic._timing(truth, 40_000, np.random.default_rng(1))
    assert drawn.std() == pytest.approx(0.3, rel=0.03)
    assert np.corrcoef(drawn[1:], drawn[:-1])[0, 1] == pytest.approx(0.6, abs=0.02)
    first = [synthetic._timing(truth, 1, np.random.default_rng(seed))[0] for seed in range(2000)]
    assert np.std(first) == pytest.approx(0.3, rel=0.06)


def test_the_way_of_a_log_leads_a_robot_of_its_numbers_over_the_same_floor() -> None:
    log, way = quiet_log()
    again = way_of(log, SILENT)
    assert len(again.forward) == len(way.forward)
    poses, counts = synthesise(again, SILENT, np.random.default_rng(0))
    inner = slice(10, log.turns - 10)
    moved, was = poses - poses[20], log.poses - log.poses[20]
    turned = np.exp(1j * (log.poses[20, 2] - poses[20, 2]))
    off = (moved[:, :2] @ (1.0, 1j)) * turned - was[:, :2] @ (1.0, 1j)
    assert np.abs(off[inner]).max() < 0.02
    assert np.abs(np.diff(counts - log.counts, axis=0)[inner]).max() < 4.0


@pytest.mark.parametrize("lag", range(-3, 4))
def test_two_ways_agree_at_whichever_lag_of_up_to_three_turns_one_is_behind(lag: int) -> None:
    noise = np.random.default_rng(0).normal(size=60)
    one, other = noise[5:50], noise[5 + lag : 50 + lag]
    assert check._agreement(one, other) == pytest.approx(1.0)
    assert check._agreement(one, -other) == pytest.approx(-1.0)
    assert check._agreement(one, 0.0 * one) == 0.0


def test_two_ways_apart_by_more_do_not_agree() -> None:
    noise = np.random.default_rng(0).normal(size=600)
    assert abs(check._agreement(noise[10:500], noise[14:504])) < 0.2


@pytest.mark.parametrize(
    ("quantum", "found"),
    [(0.01, 0.01), (0.001, 0.001), (1e-4, 1e-4), (np.radians(0.1), np.radians(0.1)), (0.03, 0.01), (7e-5, 0.0)],
)
def test_the_step_to_which_headings_are_rounded_is_the_largest_known_one(quantum: float, found: float) -> None:
    headings = quantum * np.random.default_rng(0).integers(-300, 300, 200)
    assert check._quantum(headings) == pytest.approx(found)


def test_an_interval_of_a_normal_error_reaches_its_quantile_to_either_side() -> None:
    found = normal(2.0, 0.5)
    assert (found.low, found.value, found.high) == pytest.approx((2.0 - 0.98, 2.0, 2.0 + 0.98), abs=1e-4)
    assert [found.holds(truth) for truth in (1.0, found.low, 2.9, found.high, 3.0)] == [False, True, True, True, False]
