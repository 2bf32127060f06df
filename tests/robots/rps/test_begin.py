"""How robots come to their start, and what the testbed would say in the end."""

from collections.abc import Callable

import numpy as np
import pytest

from robots.rps.session import Session, during
from robots.rps.version2.robotarium import Robotarium

GOALS = np.array([[-0.9, 0.9], [0.6, -0.6], [1.0, -2.0]])


def begun(start: str, draws: np.random.Generator | None = None) -> tuple[Robotarium, list[str]]:
    told: list[str] = []
    with during(Session("saturated", start, draws, told=told.append)):  # type: ignore[arg-type]
        return Robotarium(number_of_robots=2, initial_conditions=GOALS, show_figure=False, seed=4), told


def test_robots_stand_exactly_where_they_are_told_and_that_the_testbed_would_drive_them_is_said() -> None:
    robots, told = begun("exact")
    np.testing.assert_array_equal(robots.get_poses(), GOALS)
    assert told == [
        "the robots stand at their start at once; the testbed drives them there, and so does --drive-to-start"
    ]


def test_near_starts_are_off_by_what_the_testbed_allows_and_by_nothing_without_draws() -> None:
    robots, told = begun("near", np.random.default_rng(0))
    off = robots.get_poses() - GOALS
    assert (np.hypot(*off[:2]) <= 0.05).all()
    assert (np.abs(off[2]) <= 0.2).all()
    assert (np.abs(off) > 1e-4).all()
    assert told == []
    exact, told = begun("near")
    np.testing.assert_array_equal(exact.get_poses(), GOALS)
    assert len(told) == 1


def test_robots_that_are_driven_arrive_within_the_tolerance_and_begin_there_without_a_past(
    global_draws: Callable[[int], None],
) -> None:
    robots, told = begun("driven")
    off = robots.get_poses() - GOALS
    assert (np.hypot(*off[:2]) <= 0.05).all()
    assert (np.abs(np.angle(np.exp(1j * off[2]))) <= 0.2).all()
    assert np.hypot(*off[:2]).max() > 1e-4
    assert robots.steps == 0
    assert not robots.get_encoders().any()
    (word,) = told
    seconds = float(word.removeprefix("the robots came to their start in ").removesuffix(" s"))
    assert 2.0 < seconds < 60.0


def test_the_verdict_is_printed_as_the_testbed_sees_it(capsys: pytest.CaptureFixture[str]) -> None:
    robots, _ = begun("exact")
    for speed in (0.05, 0.3):
        robots.get_poses()
        robots.set_velocities([0, 1], np.array([[speed] * 2, [0.0] * 2]))
        robots.step()
        verdict = robots.debug()
        said = capsys.readouterr().out.splitlines()
        assert said[0] == f"The run takes about {0.033 * robots.steps:.2f} s on the testbed."
        assert verdict.accepted
        if speed < 0.2:
            assert said[1:] == ["No errors or warnings: the Robotarium would run this script."]
        else:
            assert said[1] == "No errors: the Robotarium would run this script."
            assert len(said) == 2 + len(verdict.violations) == 3
    robots, _ = begun("exact")
    poses = GOALS.copy()
    poses[:2, 1] = poses[:2, 0] + 0.1
    with during(Session("saturated")):
        robots = Robotarium(number_of_robots=2, initial_conditions=poses, show_figure=False)
    verdict = robots.call_at_scripts_end()
    assert not verdict.accepted
    assert "Errors: the Robotarium would reject this script." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("ids", "velocities", "message"),
    [
        ([0, 5], np.zeros((2, 2)), r"ids must be robots in 0\.\.1, got \[0, 5\]"),
        ([0, 1], np.zeros((3, 2)), r"velocities must have the shape \(2, 2\), got \(3, 2\)"),
        ([0, 1], np.array([[0.0, 0.0], [0.0, np.nan]]), "velocities of robot 1 must be finite"),
        ([1], np.array([[np.inf], [0.0]]), "velocities of robot 1 must be finite"),
    ],
)
def test_commands_that_make_no_sense_are_refused(ids: list[int], velocities: np.ndarray, message: str) -> None:
    robots, _ = begun("exact")
    with pytest.raises(ValueError, match=message):
        robots.set_velocities(ids, velocities)


def test_poses_and_steps_take_turns() -> None:
    robots, _ = begun("exact")
    calls: tuple[Callable[[], object], ...] = (robots.step, robots.get_poses)
    with pytest.raises(RuntimeError, match="step\\(\\) was called without get_poses"):
        calls[0]()
    robots.get_poses()
    with pytest.raises(RuntimeError, match="get_poses\\(\\) was called twice"):
        calls[1]()


def test_robots_have_no_past_and_read_nothing_before_their_first_step() -> None:
    robots, _ = begun("exact")
    assert robots.show_figure is False
    assert robots.picture is None
    simulation = robots._simulation
    assert simulation.steps == 0
    np.testing.assert_array_equal(simulation.motion, np.zeros((2, 2)))
    np.testing.assert_array_equal(simulation.turned, np.zeros((2, 2)))
    record = robots.record()
    assert record.t.tolist() == [0.0]
    assert record.poses.shape == (1, 2, 3)
    assert not record.commands.any()
    robots.get_poses()
    robots.set_velocities([0, 1], np.array([[0.1, 0.0], [0.5, -1.0]]))
    robots.step()
    np.testing.assert_allclose(simulation.motion, [[0.1, 0.5], [0.0, -1.0]], atol=1e-9)
    wheels = np.array([[0.1 - 0.055 * 0.5, 0.1 + 0.055 * 0.5], [0.055, -0.055]]) / 0.016
    np.testing.assert_allclose(simulation.turned, 0.033 * wheels)
    np.testing.assert_allclose(robots.record().wheel_speeds[1], wheels)
    np.testing.assert_allclose(robots.record().t, [0.0, 0.033])
