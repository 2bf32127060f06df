"""The loop: the theorem's rates and ends, seeds, noise, batches, contact over many seeds."""

import os
from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest

from formation import agents, decay_rates, end_configuration
from robots import GTERNAL, PLANTS
from robots.worlds import bodies, chipmunk, contact
from robots.worlds.contact import SUBSTEPS
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate, step_by_step
from scenarios.simulation.schedule import periods

Varied = Callable[..., Experiment]
SEEDS = min(100, int(os.environ.get("EVIDENCE_SEEDS", "12")))
NOISE = ("sensor.position_noise_m=0.005", "sensor.bearing_noise_deg=1.0")


def fitted_rate(experiment: Experiment, agent: int, begin: float, end: float) -> float:
    """Decay rate, 1/s, of an agent's distance to its predicted end, fitted to the logarithm over [begin, end] s."""
    run = simulate(experiment)
    predicted = end_configuration(experiment.target, *experiment.initial_points(0)[: agents.FIRST_ORDINARY])
    row = int(agents.rows(agent))
    distance = np.linalg.norm(run.points[:, row] - predicted[row], axis=-1)
    window = (run.t >= begin) & (run.t <= end)
    return -float(np.polyfit(run.t[window], np.log(distance[window]), 1)[0])


def settled(varied: Varied, *numbers: int) -> Experiment:
    """The single integrator's experiment with the named agents placed at their predicted ends."""
    ends = [(0.0, 0.5), (-0.5, 0.0), (0.5, 0.0), (0.0, -0.5), (-1.0, 0.0), (1.0, 0.0)]
    changes = [f"agents.{k}.start={list(ends[k - 1])}" for k in numbers]
    return varied("plant.name=single_integrator", *changes, duration=20.0)


@pytest.mark.parametrize(("agent", "neighbours"), [(3, ()), (4, (3,)), (5, (3, 4)), (6, (3, 4))])
def test_a_follower_of_settled_neighbours_decays_at_sin_squared_of_its_angle(
    varied: Varied, agent: int, neighbours: tuple[int, ...]
) -> None:
    experiment = settled(varied, *neighbours)
    predicted = decay_rates(experiment.target)[int(agents.rows(agent)) - agents.FIRST_ORDINARY]
    assert fitted_rate(experiment, agent, 0.0, 15.0) == pytest.approx(predicted, rel=1e-4)


@pytest.mark.parametrize("agent", [4, 5, 6])
def test_behind_a_slower_neighbour_a_follower_ends_at_the_neighbours_rate(varied: Varied, agent: int) -> None:
    """Agent 3, at 0.5 1/s, is the slowest of the cascade."""
    experiment = varied("plant.name=single_integrator")
    assert fitted_rate(experiment, agent, 30.0, 50.0) == pytest.approx(0.5, rel=0.05)


def test_the_single_integrator_ends_where_theorem_1_says(varied: Varied) -> None:
    experiment = varied("plant.name=single_integrator")
    (end,) = measure(experiment, simulate(experiment)).phases
    assert end.distances.max() < 1e-6


@pytest.mark.parametrize("plant", ["unicycle", "saturated"])
def test_the_projected_points_of_unicycles_end_where_theorem_1_says(varied: Varied, plant: str) -> None:
    experiment = varied(f"plant.name={plant}")
    (end,) = measure(experiment, simulate(experiment, 4)).phases
    assert end.distances.max() < 1e-6
    assert end.axle_angle_errors.any()


@pytest.mark.parametrize("noise", [(), NOISE])
@pytest.mark.parametrize("plant", PLANTS)
def test_the_same_seed_gives_the_same_bits_and_another_seed_another_run(
    varied: Varied, plant: str, noise: tuple[str, ...]
) -> None:
    experiment = varied(f"plant.name={plant}", *noise, duration=4.0)
    first, again, other = (simulate(experiment, seed) for seed in (7, 7, 8))
    for name in ("t", "poses", "points", "wheel_speeds", "phase"):
        assert getattr(first, name).tobytes() == getattr(again, name).tobytes()
    assert first.poses.tobytes() != other.poses.tobytes()


def test_noise_moves_the_robots_but_not_the_headings_that_the_seed_draws(varied: Varied) -> None:
    clean, noisy = varied("plant.name=unicycle", duration=1.0), varied("plant.name=unicycle", *NOISE, duration=1.0)
    a, b = simulate(clean, 3), simulate(noisy, 3)
    assert (a.poses[0] == b.poses[0]).all()
    assert np.abs(a.points[-1] - b.points[-1]).max() > 1e-4


@pytest.mark.parametrize("noise", [(), NOISE])
@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "saturated"])
def test_a_batch_of_seeds_equals_the_single_runs(varied: Varied, plant: str, noise: tuple[str, ...]) -> None:
    experiment = varied(f"plant.name={plant}", *noise, duration=3.0)
    many = simulate(experiment, [3, 1, 4])
    for index, seed in enumerate([3, 1, 4]):
        one = simulate(experiment, seed)
        np.testing.assert_allclose(many.run(index).poses, one.poses, rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(many.run(index).wheel_speeds, one.wheel_speeds, rtol=1e-6, atol=1e-8)


def test_headings_are_the_scenarios_where_it_has_them_and_the_seeds_elsewhere(varied: Varied) -> None:
    experiment = varied("agents.3.heading_deg=90.0", duration=0.1)
    first, second = (simulate(experiment, seed).poses[0, :, 2] for seed in (0, 1))
    assert first[2] == second[2] == pytest.approx(np.pi / 2.0)
    assert (np.delete(first, 2) != np.delete(second, 2)).all()


def test_drawn_headings_cover_the_circle_evenly(varied: Varied) -> None:
    experiment = varied("plant.name=unicycle", duration=0.05)
    theta = simulate(experiment, range(500)).poses[0, :, :, 2]
    assert np.abs(theta).max() <= np.pi
    assert abs(np.exp(1j * theta).mean()) < 0.05


def test_time_runs_from_zero_to_the_end_of_the_last_phase_in_whole_periods(moving: Callable[..., Experiment]) -> None:
    experiment = moving("displacement")
    run = simulate(experiment)
    assert run.t[0] == 0.0
    assert run.t[-1] == 4.0
    assert run.t[run.phase == 0][-1] == 2.0
    count, period = periods(experiment.phases[0], 0.033)
    assert abs(period - 0.033) < 0.033 / 2.0 / count
    np.testing.assert_allclose(np.diff(run.t), period, atol=1e-12)


def test_progress_is_told_once_per_period(varied: Varied) -> None:
    told: list[tuple[int, int]] = []
    run = simulate(varied(duration=1.0), on_period=lambda done, total: told.append((done, total)))
    total = len(run.t) - 1
    assert told == [(k, total) for k in range(1, total + 1)]


def test_a_run_that_diverges_is_cut_at_its_first_state_that_is_no_number(varied: Varied) -> None:
    """A Runge-Kutta step beyond its stability grows until numbers end; that is an outcome and no exception."""
    experiment = varied("plant.name=single_integrator", "plant.control_period_s=100.0", duration=50000.0)
    run = simulate(experiment)
    assert len(run.t) < 501
    assert not np.isfinite(run.poses[-1]).all()
    assert np.isfinite(run.poses[:-1]).all()
    assert measure(experiment, run).outcome == "diverged"


def penetration(states: np.ndarray) -> np.ndarray:
    """Exact depth (T, pairs), metres, of each pair of chassis at states (T, n, 3) of their centres.

    The depth of two convex polygons is the least overlap of their shadows over the normals of all their sides
    (separating axis theorem); below 0 they are apart.
    """
    length, width = GTERNAL.chassis.length / 2.0, GTERNAL.chassis.width / 2.0
    centre, ahead = states[..., 0] + 1j * states[..., 1], np.exp(1j * states[..., 2])
    i, j = np.array(list(combinations(range(states.shape[1]), 2))).T
    depth = np.full((len(states), len(i)), np.inf)
    for normal in (ahead[:, i], 1j * ahead[:, i], ahead[:, j], 1j * ahead[:, j]):
        seen = [ahead[:, k] * np.conj(normal) for k in (i, j)]
        shadows = sum(length * np.abs(box.real) + width * np.abs(box.imag) for box in seen)
        gap = np.abs(((centre[:, j] - centre[:, i]) * np.conj(normal)).real)
        depth = np.minimum(depth, shadows - gap)
    return depth


def test_the_measured_penetration_is_exact_on_boxes_placed_by_hand() -> None:
    side_by_side = np.array([[[0.0, 0.0, 0.0], [0.0, 0.10, 0.0]]])
    nose_to_tail = np.array([[[0.0, 0.0, 0.0], [0.12, 0.0, np.pi]]])
    corner_on = np.array([[[0.0, 0.0, 0.0], [0.10, 0.0, np.pi / 4.0]]])
    assert penetration(side_by_side) == pytest.approx(0.01)
    assert penetration(nose_to_tail) == pytest.approx(-0.02)
    assert penetration(corner_on) == pytest.approx(0.05 + 0.105 / np.sqrt(2.0) - 0.10)


@pytest.mark.slow
def test_over_many_seeds_without_filter_the_shape_is_reached_and_contact_is_physical(
    varied: Varied, monkeypatch: pytest.MonkeyPatch, record_property: Callable[[str, object], None]
) -> None:
    """At least 98 % reach the goal; at every solver step of every run no two chassis overlap by more than 3 mm;
    in no run does a robot slip sideways by more than 1 mm.

    Sideways slip is the sum over control periods of what the axle's centre moves across its mean heading, in absolute
    value. It counts on free floor: no contact in the period nor in the one before, in which tyres stop a shoved robot.
    """
    shape = varied("safety.filter=none")
    states: list[np.ndarray] = []

    def recorded(driven: chipmunk.Bodies, steps: int, dt: float) -> None:
        for _ in range(steps):
            chipmunk.drive(driven, 1, dt)
            states.append(driven.state[: shape.n, : chipmunk.BODY_VX].copy())
            driven.command[: shape.n] = driven.state[: shape.n, chipmunk.BODY_VX :]

    monkeypatch.setattr(bodies, "drive", recorded)
    monkeypatch.setattr(contact, "move", bodies.move.py_func)  # type: ignore[attr-defined]
    pairs = np.array(list(combinations(range(shape.n), 2)))
    touches = (pairs[:, :, None] == np.arange(shape.n)).any(axis=1)  # (pairs, n)
    reached, deepest, slipped, contacts = 0, 0.0, 0.0, 0
    for seed in range(SEEDS):
        states.clear()
        run = step_by_step(shape, seed)
        reached += bool(measure(shape, run).error_sum[-1] < 0.01)
        depth = penetration(np.array(states))
        deepest = max(deepest, float(depth.max()))
        near = (depth > -5e-4).reshape(-1, SUBSTEPS, len(pairs)).any(axis=1)
        touching = (near[:, :, None] & touches).any(axis=1)
        contacts += bool(touching.any())
        free = ~touching
        free[1:] &= ~touching[:-1]
        step = np.diff(run.poses, axis=0)
        middle = run.poses[:-1, :, 2] + step[..., 2] / 2.0
        sideways = np.abs(step[..., 1] * np.cos(middle) - step[..., 0] * np.sin(middle))
        slipped = max(slipped, float((sideways * free).sum(axis=0).max()))
    for name, value in (("reached", reached), ("deepest_m", deepest), ("slipped_m", slipped), ("contacts", contacts)):
        record_property(name, value)
    print(
        f"\n{reached}/{SEEDS} reach the goal, {contacts} have contacts, overlap {deepest * 1e3:.2f} mm, "
        f"sideways {slipped * 1e3:.2f} mm"
    )
    assert reached >= 0.98 * SEEDS
    assert contacts >= SEEDS / 2, "robots that follow the law literally do meet"
    assert deepest < 3e-3
    assert slipped < 1e-3
