"""Nothing that a robot must not know reaches its command: poisoned rows and turned frames prove it."""

from collections.abc import Callable

import numpy as np
import pytest

from scenarios.definition.experiment import Experiment
from scenarios.simulation.controller import Controller
from scenarios.simulation.loop import simulate

LAWS = ["stationary", "displacement", "distance", "bearing", "spiral"]
Moving = Callable[..., Experiment]


def controller(experiment: Experiment) -> Controller:
    made = Controller(experiment, [np.random.default_rng(0)], ())
    made.begin_phase(0)
    made.begin_period(experiment.initial_points(0), np.tile([1.0, 0.0], (experiment.n, 1)), 0.033)
    return made


@pytest.mark.parametrize("first_follower", LAWS)
def test_a_command_is_unchanged_when_every_state_that_its_robot_does_not_sense_is_poisoned(
    moving: Moving, first_follower: str
) -> None:
    """Others' headings too: a robot knows no heading but, by its compass, its own."""
    experiment = moving(first_follower)
    command = controller(experiment)
    rng = np.random.default_rng(0)
    theta = rng.uniform(-np.pi, np.pi, experiment.n)
    points, headings = experiment.initial_points(0), np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    whole = command(points, headings, 0.0)
    for k in range(experiment.n):
        edges = experiment.graph.edges
        seen = np.isin(np.arange(experiment.n), [k, *edges[edges[:, 0] == k, 1]])[:, None]
        own = (np.arange(experiment.n) == k)[:, None]
        with np.errstate(invalid="ignore"):  # the bearing of poison
            alone = command(np.where(seen, points, np.nan), np.where(own, headings, np.nan), 0.0)
        assert (alone[k] == whole[k]).all()
        assert np.isfinite(alone[k]).all()


def test_a_command_does_change_when_a_sensed_neighbour_moves(shape: Experiment) -> None:
    """So that the poison above would be noticed."""
    command = controller(shape)
    headings = np.tile([1.0, 0.0], (shape.n, 1))
    for k, i in shape.graph.edges[1:]:
        moved = shape.initial_points(0).copy()
        moved[i] += 0.1
        assert (command(moved, headings, 0.0)[k] != command(shape.initial_points(0), headings, 0.0)[k]).any()


@pytest.mark.parametrize("first_follower", LAWS)
def test_the_motion_is_the_same_in_whatever_frame_each_robot_works(moving: Moving, first_follower: str) -> None:
    """In the single integrator a heading is nothing but its robot's frame; each seed turns all of them at random."""
    experiment = moving(first_follower)
    runs = simulate(experiment, range(5))
    assert np.ptp(runs.poses[0, :, :, 2], axis=0).min() > 0.5, "the frames do differ"
    for seed in range(1, 5):
        np.testing.assert_allclose(runs.points[:, seed], runs.points[:, 0], atol=1e-12)


def test_the_motion_changes_where_one_robot_works_in_a_mirrored_frame(shape: Experiment) -> None:
    """The paper's remark that no common sense of rotation is needed does not hold for a mirrored robot."""
    observer, observed = shape.graph.edges.T
    mirror = np.ones((shape.n, 2))
    mirror[2] = [1.0, -1.0]

    def end(frames: np.ndarray) -> np.ndarray:
        points = shape.initial_points(0).copy()
        for _ in range(2000):
            relative = (points[observed] - points[observer]) * frames[observer]
            points = points + 0.01 * shape.law(relative) * frames
        return points

    upright, mirrored = end(np.ones((shape.n, 2))), end(mirror)
    assert np.abs(shape.angles.errors(upright, shape.target_angles)).sum() < 1e-3
    assert np.abs(shape.angles.errors(mirrored, shape.target_angles)).sum() > 0.1


@pytest.mark.parametrize("plant", ["unicycle", "saturated"])
def test_turning_and_shifting_the_whole_experiment_turns_and_shifts_the_motion(
    varied: Callable[..., Experiment], plant: str
) -> None:
    """The world has no preferred place or direction, and shape control needs none."""
    turn, shift = 0.7, np.array([3.0, -4.0])
    rotated = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    heading_deg = [10.0, -50.0, 120.0, 80.0, -170.0, 33.0]

    def run(turned: float) -> np.ndarray:
        here = varied(f"plant.name={plant}", *_headings(np.add(heading_deg, turned)), duration=5.0)
        if turned:
            starts = here.initial_points(0) @ rotated + shift
            changes = [f"agents.{k}.start={p}" for k, p in enumerate(starts.tolist(), start=1)]
            here = varied(f"plant.name={plant}", *_headings(np.add(heading_deg, turned)), *changes, duration=5.0)
        return simulate(here).points

    np.testing.assert_allclose(run(float(np.degrees(turn))), run(0.0) @ rotated + shift, atol=1e-9)


def _headings(degrees: np.ndarray) -> list[str]:
    return [f"agents.{k}.heading_deg={d}" for k, d in enumerate(degrees.tolist(), start=1)]
