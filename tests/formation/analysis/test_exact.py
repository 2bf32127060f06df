"""The exact motion: the first follower in closed form, the cascade that it drives, commands that are held or change."""

import math
from itertools import islice

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from formation import EDGE_LAWS, AngleLaw, Phase, TargetFormation, VelocityEstimator, random_target
from formation.analysis import cascade, exact, first_follower, lags
from formation.analysis.cascade import Cascade
from formation.analysis.exact import held, ideal, points, steer
from formation.plane import as_complex, as_vectors
from formation.references.protocol import NO_BENDS
from formation.references.ramps import Ramps

SEEDS = st.integers(0, 2**32 - 1)
LAWS = ["stationary", "displacement", "distance", "bearing", "spiral"]
PHASE = Phase("p", 3.0, (0.05, -0.02), (0.3, 0.4))


def velocity(target: TargetFormation, law: str, p: np.ndarray, phase: Phase = PHASE) -> np.ndarray:
    """What eq. (man) asks of agents at p (n, 2)."""
    edges = target.graph.edges
    compass = np.tile([1.0, 0.0], (len(p), 1))
    return AngleLaw(target, law)(p[edges[:, 1]] - p[edges[:, 0]], compass, np.array(phase.delta)) + phase.velocity


def runge_kutta(target: TargetFormation, law: str, p: np.ndarray, h: float, steps: int) -> np.ndarray:
    states = [p]
    for _ in range(steps):
        k1 = velocity(target, law, p)
        k2 = velocity(target, law, p + h / 2 * k1)
        k3 = velocity(target, law, p + h / 2 * k2)
        k4 = velocity(target, law, p + h * k3)
        p = p + h / 6 * (k1 + 2 * (k2 + k3) + k4)
        states.append(p)
    return np.array(states)


@pytest.mark.parametrize("law", LAWS)
@given(
    start=st.complex_numbers(min_magnitude=0.1, max_magnitude=2.0),
    length=st.floats(0.1, 2.0),
    turn=st.floats(-3.0, 3.0),
    t=st.floats(0.0, 20.0),
)
def test_the_first_followers_motion_solves_its_law(
    law: str, start: complex, length: float, turn: float, t: float
) -> None:
    delta = length * start / abs(start) * np.exp(1j * turn)
    e, h = first_follower.motion(law, start, delta).at, 1e-5
    slope = (e(np.array(t + h)) - e(np.array(t - h))) / (2 * h)
    asked = EDGE_LAWS[law](e(np.array([t])), np.array(delta))[0]
    assert abs(slope - asked) < 1e-6 * max(1.0, 1.0 / abs(start), abs(delta) ** 3, abs(start) ** 3)
    assert e(np.array(0.0)) == pytest.approx(start, abs=1e-12)


@pytest.mark.parametrize("law", ["displacement", "distance", "bearing", "spiral"])
@given(start=st.floats(0.3, 1.0), length=st.floats(0.3, 1.0), turn=st.floats(-2.0, 2.0))
def test_the_first_follower_nears_its_end_at_its_late_rate(law: str, start: float, length: float, turn: float) -> None:
    e_0, delta = complex(start), length * np.exp(1j * turn)
    e, rate = first_follower.motion(law, e_0, delta).at, first_follower.rate(law, e_0, delta)
    end, late = e(np.array(40.0 / rate)), np.array([7.0, 8.0]) / rate
    assume(abs(e_0 - end) > 1e-2)
    earlier, later = np.abs(e(late) - end)
    assert np.log(earlier / later) == pytest.approx(1.0, abs=0.02)


def test_the_bearing_law_leaves_only_the_antipode_where_it_is_and_the_distance_law_only_one_place() -> None:
    t = np.array([0.0, 50.0])
    opposite = first_follower.motion("bearing", -1.0 + 0j, 1.0 + 0j).at(t[:1])
    assert EDGE_LAWS["bearing"](opposite, np.array(1.0 + 0j)) == pytest.approx(0.0, abs=1e-12)
    nearly = first_follower.motion("bearing", np.exp(1j * (np.pi - 1e-3)), 1.0 + 0j).at(t)
    assert abs(nearly[1] - 1.0) < 1e-12
    assert (first_follower.motion("distance", 0j, 1.0 + 0j).at(t) == 0.0).all()
    assert first_follower.motion("distance", 1e-6 + 0j, 1.0 + 0j).at(t)[1] == pytest.approx(1.0)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=8)
@given(seed=SEEDS)
def test_the_exact_motion_is_where_fine_runge_kutta_steps_of_the_law_lead(law: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(7, rng)
    start = rng.normal(size=(7, 2))
    start[1] = start[0] + as_vectors(rng.uniform(0.3, 1.5) * np.exp(2j * np.pi * rng.uniform()))
    loop = Cascade.of(target)
    exact = points(ideal(loop, as_complex(start), PHASE, law, 0.25), 8)
    fine = runge_kutta(target, law, start, 0.005, 400)[::50]
    np.testing.assert_allclose(exact, fine, atol=1e-8 * max(1.0, np.abs(loop.pulls).max() ** 5))


@pytest.mark.parametrize("law", LAWS)
def test_held_commands_take_the_points_straight(law: str) -> None:
    rng = np.random.default_rng(5)
    target = random_target(9, rng)
    p = rng.normal(size=(9, 2))
    for state in islice(held(Cascade.of(target), as_complex(p), PHASE, law, 0.033), 20):
        np.testing.assert_allclose(as_vectors(state), p, atol=1e-11)
        p = p + 0.033 * velocity(target, law, p)


def test_a_first_follower_from_afar_by_distance_is_followed_exactly() -> None:
    """Its motion has a singularity just before time 0."""
    rng = np.random.default_rng(8)
    target = random_target(5, rng)
    start = rng.normal(size=(5, 2))
    start[1] = start[0] + [4.0, 0.0]
    exact = points(ideal(Cascade.of(target), as_complex(start), PHASE, "distance", 0.1), 3)
    fine = runge_kutta(target, "distance", start, 0.0005, 600)[::200]
    np.testing.assert_allclose(exact, fine, atol=1e-9)


def test_a_first_follower_far_too_fast_for_the_step_is_followed_in_no_time() -> None:
    """It is where it belongs after a picosecond; the followers then see a pair that stands."""
    rng = np.random.default_rng(9)
    target = random_target(5, rng)
    start = rng.normal(size=(5, 2))
    fast = Phase("p", 1.0, delta=(1e6, 0.0))
    moved = as_complex(points(ideal(Cascade.of(target), as_complex(start), fast, "distance", 0.05), 4))
    moved = moved - moved[:, :1]
    settled = first_follower.motion("distance", moved[0, 1], 1e6 + 0j).at(np.array(1.0))
    standing = as_complex(start) - as_complex(start)[0]
    standing[1] = settled
    expected = Cascade.of(target).exponential(0.2) @ standing
    np.testing.assert_allclose(moved[-1], expected, rtol=1e-9)


def test_many_motions_at_once_are_the_single_ones() -> None:
    rng = np.random.default_rng(6)
    target = random_target(6, rng)
    loop, starts = Cascade.of(target), as_complex(rng.normal(size=(6, 3, 2)))
    for move in (ideal, held):
        for law in LAWS:
            together = list(islice(move(loop, starts, PHASE, law, 0.05), 10))[-1]
            alone = [list(islice(move(loop, starts[:, c], PHASE, law, 0.05), 10))[-1] for c in range(3)]
            np.testing.assert_allclose(together, np.stack(alone, axis=1), atol=1e-12)


@pytest.mark.parametrize("law", ["stationary", "displacement"])
def test_on_ramps_the_exact_motion_is_where_fine_runge_kutta_steps_lead_through_every_bend(law: str) -> None:
    """The bends at 0.37 and 1.5 s lie inside and at the end of a step."""
    rng = np.random.default_rng(4)
    target = random_target(6, rng)
    ramps = Ramps(
        np.array([0.0, 0.37, 1.5, 1.7]), np.array([0.0, 0.1, 0.1j, 0.0]), np.array([1.0, 0.8, 1.3, 1.3]),
        np.array([0.0, 0.6, -0.4, 0.0]),
    )  # fmt: skip
    delta, phase = 0.3 + 0.4j, Phase("p", 2.0, delta=(0.3, 0.4), reference=ramps)
    start, h = as_complex(rng.normal(size=(6, 2))), 0.005

    def velocity(p: np.ndarray, t: float) -> np.ndarray:
        u = Cascade.of(target).apply(p) + ramps.velocity(t)
        if law == "displacement":
            u[1] += delta * ramps.factor(t) - (p[1] - p[0])
        return u

    states = [start]
    for step in range(400):
        p, t = states[-1], step * h
        k1 = velocity(p, t)
        k2 = velocity(p + h / 2 * k1, t + h / 2)
        k3 = velocity(p + h / 2 * k2, t + h / 2)
        states.append(p + h / 6 * (k1 + 2 * (k2 + k3) + velocity(p + h * k3, t + h)))
    exact = as_complex(points(ideal(Cascade.of(target), start, phase, law, 0.25), 8))
    np.testing.assert_allclose(exact, np.array(states)[::50], atol=1e-8)
    late = as_complex(points(ideal(Cascade.of(target), exact[3], phase, law, 0.25, 0.75), 5))
    np.testing.assert_allclose(late, exact[3:], atol=1e-12)


@settings(max_examples=8)
@given(seed=SEEDS, slope=st.complex_numbers(min_magnitude=0.01, max_magnitude=0.2))
def test_behind_a_ramped_displacement_the_followers_lag_as_predicted(seed: int, slope: complex) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng, min_angle=np.radians(30.0))
    start = as_complex(rng.normal(size=(6, 2)))
    *_, late = islice(steer(Cascade.of(target, 1.0), start, lambda t: 0.3 - 0.2j + slope * t, NO_BENDS, 0.1, 0.0), 1501)
    lag = late - lags.shares(target) * (0.3 - 0.2j + slope * 150.0)
    np.testing.assert_allclose(lag, lags.ramp_lags(target, slope), atol=1e-9 * (1.0 + np.abs(lag).max()))


@settings(max_examples=8)
@given(seed=SEEDS, omega=st.floats(0.05, 1.0))
def test_a_turning_displacement_shrinks_and_twists_the_shape_as_predicted(seed: int, omega: float) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(6, rng, min_angle=np.radians(30.0))
    delta = 0.4 + 0.3j
    start = as_complex(rng.normal(size=(6, 2)))
    turning = steer(Cascade.of(target, 1.0), start, lambda t: delta * np.exp(1j * omega * t), NO_BENDS, 0.1, 0.0)
    *_, late = islice(turning, 1501)
    gains = lags.turning_gains(target, omega)
    np.testing.assert_allclose(late, gains * delta * np.exp(1j * omega * 150.0), atol=1e-9 * np.abs(gains).max())
    np.testing.assert_allclose(lags.turning_gains(target, 1e-9), lags.shares(target), atol=1e-6)


def test_in_the_papers_shape_a_turn_of_a_fifth_of_a_radian_a_second_leaves_27_percent(paper: TargetFormation) -> None:
    places, settled = lags.shares(paper), lags.turning_gains(paper, 0.2)
    wanted, found = places - places.mean(), settled - settled.mean()
    similar = np.vdot(wanted, found) / np.vdot(wanted, wanted) * wanted
    assert np.linalg.norm(found - similar) / np.linalg.norm(found) == pytest.approx(0.27, abs=0.001)


def test_behind_a_ramped_velocity_spread_by_consensus_the_agents_lag_as_predicted() -> None:
    target = random_target(6, np.random.default_rng(2), min_angle=np.radians(30.0))
    edges, kappa, slope, h = target.graph.edges, 2.0, np.array([0.003, -0.001]), 0.01
    estimator, estimates = VelocityEstimator(6, edges, kappa), np.zeros((6, 2))
    loop, delta = Cascade.of(target, 1.0), 0.3 + 0.4j
    q = lags.shares(target) * delta
    for step in range(5_000):
        estimates = estimator.step(estimates, slope * (step * h), h)
        pull = loop.apply(q)
        pull[1] = delta - q[1]
        pull += as_complex(estimates) - as_complex(estimates)[0]
        q = q + h * pull
    predicted = lags.velocity_lags(target, edges, kappa, complex(*slope))
    np.testing.assert_allclose(q - lags.shares(target) * delta, predicted, rtol=0.02, atol=1e-6)


@pytest.mark.parametrize("law", ["displacement", "distance"])
def test_many_agents_move_as_few_do_though_no_full_matrix_is_made(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    target = random_target(40, np.random.default_rng(3))
    start = as_complex(np.random.default_rng(4).uniform(-1.0, 1.0, (40, 2)))
    by_matrix = points(ideal(Cascade.of(target), start, PHASE, law, 0.25), 12)
    monkeypatch.setattr(exact, "DENSE", 10)
    by_rows = points(ideal(Cascade.of(target), start, PHASE, law, 0.25), 12)
    np.testing.assert_allclose(by_rows, by_matrix, rtol=0.0, atol=1e-12)


@given(st.floats(1e-6, 1.0))
def test_the_series_ends_where_what_is_left_out_is_below_rounding(norm: float) -> None:
    terms = cascade._terms(norm)
    rest = sum(norm**k / math.factorial(k) for k in range(terms + 1, terms + 20))
    assert rest < np.finfo(float).eps / 32.0
