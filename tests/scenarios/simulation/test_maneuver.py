"""The paper's maneuvers, from the scenario files, as ideal single integrators and as robots."""

from dataclasses import replace

import numpy as np
import pytest

from formation import end_similarity, wrap
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.predictions.forecast import NEAR, forecast
from scenarios.measures.tracking import predicted_ends, reference, track
from scenarios.simulation.loop import simulate

IDEAL = ("plant.name=single_integrator",)


@pytest.fixture(scope="module")
def maneuver():
    experiment = open_experiment("maneuver", IDEAL)
    trajectory = simulate(experiment, 0)
    return experiment, trajectory, measure(experiment, trajectory)


def test_agents_1_and_2_end_each_phase_where_the_paper_sends_them(maneuver) -> None:
    _, trajectory, metrics = maneuver
    leader = [trajectory.points[end.row, 0] for end in metrics.phases]
    np.testing.assert_allclose(leader, [(-0.4, 0.65), (1.6, 0.65), (2.8, 0.65)], atol=1e-6)
    displacement = [trajectory.points[end.row, 1] - trajectory.points[end.row, 0] for end in metrics.phases]
    np.testing.assert_allclose(displacement, [(0.4, 0.4), (0.4, -0.4), (0.28, -0.28)], atol=1e-6)


def test_angle_errors_at_the_phase_ends_are_those_of_the_exact_closed_loop(maneuver) -> None:
    experiment, trajectory, metrics = maneuver
    sums = np.array([np.abs(end.angle_errors).sum() for end in metrics.phases])
    np.testing.assert_allclose(sums, [5.6e-10, 5.9e-8, 3.5e-6], rtol=0.3)
    exact = [phase.error_sum for phase in forecast(experiment, trajectory.points[0])]
    np.testing.assert_allclose(sums, exact, rtol=0.01)


def test_velocities_equal_v_r_at_the_phase_ends(maneuver) -> None:
    experiment, trajectory, metrics = maneuver
    for end, phase in zip(metrics.phases, experiment.phases, strict=True):
        row = end.row
        velocity = (trajectory.points[row] - trajectory.points[row - 1]) / (trajectory.t[row] - trajectory.t[row - 1])
        np.testing.assert_allclose(velocity, np.tile(phase.velocity, (6, 1)), atol=1e-6)


def test_the_forecast_is_where_the_ideal_agents_are(maneuver) -> None:
    experiment, trajectory, metrics = maneuver
    for end, ahead in zip(metrics.phases, forecast(experiment, trajectory.points[0]), strict=True):
        np.testing.assert_allclose(trajectory.points[end.row], ahead.points, atol=1e-7)
        np.testing.assert_allclose(end.predicted, ahead.end, atol=1e-12)


def test_all_agents_are_near_their_places_when_the_forecast_says_so(maneuver) -> None:
    experiment, trajectory, _ = maneuver
    far = track(experiment, trajectory).distances.max(axis=1)
    begin = 0.0
    for index, (phase, ahead) in enumerate(
        zip(experiment.phases, forecast(experiment, trajectory.points[0]), strict=True)
    ):
        inside = (trajectory.phase == index) & (trajectory.t > begin)
        late = trajectory.t[inside] >= begin + ahead.arrival
        assert (far[inside][late] < NEAR).all()
        assert far[inside][~late][-3:].max() >= 0.9 * NEAR
        begin += phase.duration


def test_tracking_vanishes_on_the_reference_itself_and_sees_each_deviation_alone(maneuver) -> None:
    experiment, trajectory, _ = maneuver
    wanted = reference(experiment, trajectory)

    def errors(points):
        points = np.concatenate([trajectory.points[:1], points[1:]])  # the prediction starts from the true start
        tracking = track(experiment, replace(trajectory, points=points))
        return tracking.scale[1:], tracking.orientation[1:], tracking.translation[1:], tracking.distances[1:]

    for series in errors(wanted):
        np.testing.assert_allclose(series, 0.0, atol=1e-9)
    centre = wanted.mean(axis=1, keepdims=True)
    turn = np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
    for points, expected in (
        (centre + 1.1 * (wanted - centre), (0.1, 0.0, 0.0)),
        (centre + (wanted - centre) @ turn, (0.0, 0.2, 0.0)),
        (wanted + [0.3, 0.4], (0.0, 0.0, 0.5)),
    ):
        for series, value in zip(errors(points)[:3], expected, strict=True):
            np.testing.assert_allclose(series, value, atol=1e-9)


def test_maneuver_reports_when_where_and_who_leaves_the_testbed(maneuver) -> None:
    experiment, trajectory, metrics = maneuver
    [floor] = [v.first for v in metrics.verdict.violations if v.kind == "floor"]
    row = int(np.flatnonzero(trajectory.t == floor.time)[0])
    assert experiment.arena.contains(trajectory.poses[:row, :, :2]).all()
    [robot] = floor.robots
    assert not experiment.arena.contains(trajectory.poses[row, robot, :2])
    np.testing.assert_allclose(floor.place, trajectory.poses[row, robot, :2])
    assert not metrics.verdict.accepted


@pytest.mark.parametrize("plant", ["single_integrator", "saturated", "pymunk"])
def test_maneuver_testbed_never_leaves_the_floor(plant: str) -> None:
    experiment = open_experiment("maneuver-testbed", (f"plant.name={plant}",))
    assert experiment.arena.walls
    for seed in range(3):
        metrics = measure(experiment, simulate(experiment, seed))
        assert [v for v in metrics.verdict.violations if v.kind == "floor"] == []


def test_the_captions_rotation_is_the_texts_with_the_other_sign() -> None:
    text, caption = (open_experiment(name) for name in ("maneuver", "maneuver-caption"))
    for a, b in zip(text.phases[1:], caption.phases[1:], strict=True):
        np.testing.assert_allclose(a.delta, -np.array(b.delta), atol=1e-12)
        assert a.velocity == b.velocity


@pytest.mark.parametrize(("scenario", "keeps"), [("scale-only", "orientation"), ("orientation-only", "scale")])
def test_a_partial_first_follower_steers_one_thing_and_keeps_the_other(scenario: str, keeps: str) -> None:
    experiment = open_experiment(scenario, IDEAL)
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    assert metrics.outcome == "converged"
    before = end_similarity(experiment.target, *trajectory.points[0, :2])
    for end, phase in zip(metrics.phases, experiment.phases, strict=True):
        after = end_similarity(experiment.target, *trajectory.points[end.row, :2])
        commanded = complex(*phase.delta)
        star = complex(*(experiment.target.positions[1] - experiment.target.positions[0]))
        if keeps == "orientation":
            assert wrap(after.angle - before.angle) == pytest.approx(0.0, abs=1e-9)
            assert after.scale == pytest.approx(abs(commanded / star), abs=1e-6)
        else:
            assert after.scale == pytest.approx(before.scale, abs=1e-6)
            assert wrap(after.angle - np.angle(commanded / star)) == pytest.approx(0.0, abs=1e-6)


def test_the_fastest_shape_has_right_follower_angles_and_settles_first() -> None:
    fastest, shape = (open_experiment(name, IDEAL) for name in ("fastest", "shape"))
    np.testing.assert_allclose(np.abs(np.sin(fastest.target.follower_angles)), 1.0, atol=1e-12)
    times = [measure(e, simulate(e, 0)).settling_time for e in (fastest, shape)]
    assert times[0] < 0.7 * times[1]


def test_a_velocity_that_only_the_leader_knows_is_followed_by_all() -> None:
    experiment = open_experiment("consensus-velocity", IDEAL)
    trajectory = simulate(experiment, 0)
    first = np.linalg.norm(np.diff(trajectory.points[:3], axis=0), axis=2)[0]
    assert first[0] > 0.0
    for end, phase in zip(measure(experiment, trajectory).phases, experiment.phases, strict=True):
        velocity = (trajectory.points[end.row] - trajectory.points[end.row - 1]) / np.diff(trajectory.t)[end.row - 1]
        np.testing.assert_allclose(velocity, np.tile(phase.velocity, (6, 1)), atol=1e-6)


def test_an_agent_that_cannot_hear_the_leader_is_named() -> None:
    with pytest.raises(InputError, match=r"communication\.edges: .*agents 5, 6 cannot hear"):
        open_experiment("consensus-velocity", ("communication.edges=[[2, 1], [3, 2], [4, 3], [5, 6], [6, 5]]",))


def test_sequential_followers_wait_and_keep_the_lemmas_margin() -> None:
    experiment = open_experiment("sequential", IDEAL)
    trajectory = simulate(experiment, 0)
    starts = trajectory.active.argmax(axis=0)
    i, j, k = experiment.graph.triangles.T
    assert (starts[k[1:]] > 0).all()
    for a, b, c in zip(i, j, k, strict=True):
        assert starts[c] >= max(starts[a], starts[b])
        waiting = trajectory.points[: starts[c], c]
        np.testing.assert_allclose(waiting - trajectory.points[0, c], 0.0, atol=1e-12)
    assert measure(experiment, trajectory).outcome == "converged"


@pytest.mark.slow
def test_axle_errors_vanish_where_headings_align_and_stay_where_they_do_not() -> None:
    sums = {}
    for name in ("maneuver", "shape"):
        experiment = open_experiment(name, ("plant.name=saturated",))
        sums[name] = [measure(experiment, simulate(experiment, seed)).axle_error_sum[-1] for seed in range(10)]
    assert max(sums["maneuver"]) < 1e-3
    assert min(sums["shape"]) > 0.02


def test_predicted_ends_do_not_depend_on_the_plant() -> None:
    ends = [
        predicted_ends(open_experiment("maneuver", (f"plant.name={p}",)), open_experiment("maneuver").initial_points(0))
        for p in ("single_integrator", "pymunk")
    ]
    np.testing.assert_array_equal(*ends)
