"""Random poses, arrival, turns, sizes in a figure."""

import re
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.rps.version1 import misc as first
from robots.rps.version2 import misc as second


@pytest.mark.parametrize("n", [1, 5, 12])
def test_random_poses_are_apart_on_their_rectangle(n: int, global_draws: Callable[[int], None]) -> None:
    for make in (second.generate_random_poses, first.generate_initial_conditions):
        poses = make(n, 0.3, 2.0, 1.2)
        assert poses.shape == (3, n)
        assert (np.abs(poses) <= [[1.0], [0.6], [np.pi]]).all()
        gaps = np.linalg.norm(poses[:2, :, None] - poses[:2, None], axis=0) + np.eye(n)
        assert gaps.min() >= 0.3
    assert second.generate_random_positions(n, 0.3, 2.0, 1.2).shape == (2, n)


def test_poses_that_cannot_fit_are_refused(global_draws: Callable[[int], None]) -> None:
    with pytest.raises(ValueError, match="N must be at most 4"):
        second.generate_random_poses(5, 0.5, 1.0, 1.0)
    with pytest.raises(ValueError, match="no place was found"):
        first.generate_initial_conditions(60, 0.2, 2.0, 1.4)


def test_chargers_are_on_the_long_sides_and_look_inwards(global_draws: Callable[[int], None]) -> None:
    poses = second.generate_initial_poses(22, 3.0, 1.0)
    assert len({tuple(place) for place in poses[:2].T.tolist()}) == 22
    assert set(np.abs(poses[1]).tolist()) == {0.5}
    np.testing.assert_allclose(np.sin(poses[2]), -np.sign(poses[1]))
    with pytest.raises(ValueError):
        second.generate_initial_poses(23)


@given(st.floats(0.0, 0.1), st.floats(-np.pi, np.pi), st.floats(-4.0, 4.0))
def test_who_has_arrived_is_near_in_place_and_heading(distance: float, bearing: float, turn: float) -> None:
    goals = np.array([[0.3, 0.0], [0.2, 0.0], [1.0, 0.0]])
    states = goals.copy()
    states[:, 0] += [distance * np.cos(bearing), distance * np.sin(bearing), turn]
    near = np.hypot(*(states - goals)[:2, 0]) <= 0.05
    straight = abs(np.angle(np.exp(1j * turn))) <= 0.2
    done, who = second.create_at_pose()(states, goals)
    assert who.tolist() == [near and straight, True]
    assert done == (near and straight)
    assert second.create_at_position()(states, goals[:2])[1].tolist() == [near, True]
    assert first.at_pose(states, goals)[0].tolist() == np.flatnonzero(who).tolist()
    assert np.size(first.at_position(states, goals[:2], 0.05)) == near + 1


@given(st.lists(st.floats(-7.0, 7.0), min_size=1, max_size=4))
def test_turns_turn(angles: list[float]) -> None:
    turns = second.rotation_matrix(angles)
    assert turns.shape == (3, 3, len(angles))
    for k, angle in enumerate(angles):
        np.testing.assert_allclose(turns[:, :, k] @ [1.0, 0.0, 2.0], [np.cos(angle), np.sin(angle), 2.0])
    np.testing.assert_array_equal(first.rotation_matrix(np.array(angles)), np.moveaxis(turns, 2, 0))


def test_a_unique_name_says_when() -> None:
    assert re.fullmatch(r"data_\d{4}(_\d\d){5}\.npy", second.unique_filename("data"))


def test_sizes_follow_the_figure() -> None:
    figure = SimpleNamespace(get_size_inches=lambda: np.array([8.0, 4.0]), dpi=100.0)
    robots = SimpleNamespace(_fig=figure, BOUNDARIES=np.array([-1.6, 1.6, -1.0, 1.0]))
    assert second.determine_font_size(robots, 0.1) == pytest.approx(20.0)
    extent = SimpleNamespace(get_points=lambda: np.array([[0.0, 10.0], [640.0, 330.0]]))
    transform = SimpleNamespace(transform=lambda sizes: 200.0 * sizes)
    axes = SimpleNamespace(get_window_extent=lambda: extent, transData=transform)
    robots = SimpleNamespace(axes=axes, boundaries=[-1.6, -1.0, 3.2, 2.0])
    assert first.determine_font_size(robots, 0.1) == pytest.approx(10.0)
    assert first.determine_marker_size(robots, 0.1) == pytest.approx(400.0)
