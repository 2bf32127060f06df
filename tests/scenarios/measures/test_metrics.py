"""Measures of a run."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import measure, settling_time
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory

TIMES = np.arange(6) * 0.5


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0),
        ([9.0, 9.0, 0.1, 0.1, 0.1, 0.1], 1.0),
        ([9.0, 0.1, 9.0, 0.1, 0.1, 0.1], 1.5),
        ([9.0, 9.0, 9.0, 9.0, 9.0, 0.1], 2.5),
        ([0.1, 0.1, 0.1, 0.1, 0.1, 9.0], None),
        ([0.1, 0.1, 0.1, 0.1, 0.1, np.nan], None),
        ([9.0, np.nan, 0.1, 0.1, 0.1, 0.1], 1.0),
        ([9.0, 9.0, 1.0, 0.1, 0.1, 0.1], 1.5),
    ],
)
def test_a_run_settles_where_its_error_stays_below_the_bound_for_good(
    errors: list[float], expected: float | None
) -> None:
    assert settling_time(TIMES, np.array(errors), 1.0) == expected


@given(st.lists(st.floats(0.0, 2.0), min_size=1, max_size=30))
def test_everything_from_the_settling_time_on_is_below_the_bound_and_what_comes_just_before_is_not(
    errors: list[float],
) -> None:
    t, e = np.arange(len(errors), dtype=float), np.array(errors)
    settled = settling_time(t, e, 1.0)
    if settled is None:
        assert e[-1] >= 1.0
    else:
        assert (e[t >= settled] < 1.0).all()
        assert settled == 0.0 or e[int(settled) - 1] >= 1.0


@pytest.fixture
def standing(shape: Experiment, recorded: Callable[..., Trajectory]) -> Callable[[np.ndarray], Trajectory]:
    """Makes four states of robots that stand at projected points, all with heading 0."""

    def make(points: np.ndarray) -> Trajectory:
        poses = np.zeros((4, shape.n, 3))
        poses[..., :2] = points - [shape.nid.projection_distance, 0.0]
        return recorded(np.arange(4) * 0.1, poses, np.tile(points, (4, 1, 1)))

    return make


Standing = Callable[[np.ndarray], Trajectory]


def test_robots_that_stand_in_the_shape_have_converged_from_the_start(shape: Experiment, standing: Standing) -> None:
    found = measure(shape, standing(shape.target.positions))
    assert found.outcome == "converged"
    assert found.settling_time == 0.0
    assert found.error_sum.max() < 1e-12
    assert found.axle_error_sum.max() < 1e-12, "equal headings shift all axles alike"


def test_the_error_sum_adds_up_absolute_errors(shape: Experiment, standing: Standing) -> None:
    found = measure(shape, standing(shape.initial_points(0)))
    assert found.outcome == "not_converged"
    assert found.settling_time is None
    np.testing.assert_allclose(found.error_sum, np.abs(found.angle_errors).sum(axis=1))


def test_the_separation_is_between_collision_centres(shape: Experiment, standing: Standing) -> None:
    """With l = 0.025 m the projected points are the collision centres."""
    found = measure(shape, standing(shape.initial_points(0)))
    p = shape.initial_points(0)
    nearest = min(np.linalg.norm(p[a] - p[b]) for a in range(6) for b in range(a))
    assert found.separation.distance == pytest.approx(nearest)


def test_a_run_that_ends_in_no_number_has_diverged_and_completed_no_phase(
    shape: Experiment, standing: Standing
) -> None:
    run = standing(shape.initial_points(0))
    run.points[-1] = run.poses[-1] = np.nan
    found = measure(shape, run)
    assert found.outcome == "diverged"
    assert found.phases == ()
    assert found.settling_time is None


def test_each_phase_is_measured_at_its_own_end(moving: Callable[..., Experiment]) -> None:
    experiment = moving("displacement")
    run = simulate(experiment)
    found = measure(experiment, run)
    assert [end.name for end in found.phases] == ["up", "right"]
    assert [run.t[end.row] for end in found.phases] == [2.0, 4.0]
    for end in found.phases:
        np.testing.assert_allclose(end.distances, np.linalg.norm(run.points[end.row] - end.predicted, axis=-1))
        assert end.distances[0] < 1e-12, "the leader integrates v_r"


def test_axle_centres_keep_an_angle_error_where_headings_end_different(shape: Experiment, standing: Standing) -> None:
    found = measure(shape, simulate(shape))
    assert found.error_sum[-1] < 1e-6
    assert 0.01 < found.axle_error_sum[-1] < 0.5
