"""The Robotarium's interface over our worlds: scripts for the public simulator run, and wrong use is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, judge
from robots.robotarium import Robotarium, create_si_barrier_certificate_with_boundary
from robots.testbed import collision_centres, separation

SCRIPT = """
import numpy as np
from rps.robotarium import Robotarium

goals = np.array([[0.6, -0.6, 0.0], [0.4, 0.4, -0.5]])
start = np.array([[0.0, 0.4, -0.4], [0.7, -0.3, -0.3], [0.0, 1.0, -2.0]])
r = Robotarium(number_of_robots=3, show_figure=True, initial_conditions=start, sim_in_real_time=True)
for _ in range(900):
    x = r.get_poses()
    forward = np.array([np.cos(x[2]), np.sin(x[2])])
    left = np.array([-forward[1], forward[0]])
    wish = 0.5 * (goals - x[:2] - 0.05 * forward)
    wish *= 0.08 / np.maximum(np.linalg.norm(wish, axis=0), 0.08)
    r.set_velocities(np.arange(3), np.array([(forward * wish).sum(axis=0), (left * wish).sum(axis=0) / 0.05]))
    r.step()
x = r.get_poses()
reached = x[:2] + 0.05 * np.array([np.cos(x[2]), np.sin(x[2])])
r.call_at_scripts_end()
"""

PLANTS = ("unicycle", "saturated", "pymunk")


def test_a_script_for_the_public_simulator_runs_unchanged_but_for_its_import(
    capsys: pytest.CaptureFixture[str],
) -> None:
    names: dict[str, np.ndarray] = {}
    exec(SCRIPT.replace("from rps.robotarium", "from robots.robotarium"), names)
    np.testing.assert_allclose(names["reached"], names["goals"], atol=1e-4)
    assert "would run this script" in capsys.readouterr().out


@given(
    st.floats(-0.1, 0.1),
    st.floats(-1.8, 1.8),
    st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-3.1, 3.1)),
)
def test_one_step_differs_from_eulers_by_less_than_half_the_turn_of_the_way(
    v: float, omega: float, pose: tuple[float, float, float]
) -> None:
    """The public simulator integrates by Euler; the worlds move on the arc."""
    r = Robotarium(initial_conditions=np.array([pose]).T, plant="saturated")
    x, y, theta = r.get_poses()[:, 0]
    r.set_velocities([0], [[v], [omega]])
    r.step()
    after = r.get_poses()[:, 0]
    step, turn = r.TIME_STEP * v, r.TIME_STEP * omega
    apart = np.hypot(after[0] - x - step * np.cos(theta), after[1] - y - step * np.sin(theta))
    assert apart <= abs(step * turn) / 2.0 + 1e-15
    assert np.angle(np.exp(1j * (after[2] - theta - turn))) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("plant", PLANTS)
def test_a_robot_keeps_its_command_until_the_next_one(plant: str) -> None:
    r = Robotarium(initial_conditions=np.zeros((3, 1)), plant=plant)
    for step in range(101):
        r.get_poses()
        if step == 0:
            r.set_velocities([0], [[0.1], [0.0]])
        r.step()
    assert r.get_poses()[0, 0] == pytest.approx(101 * 0.0033, abs=2e-3)


def test_commands_go_to_the_robots_that_are_named() -> None:
    r = Robotarium(initial_conditions=np.array([[0.0, 0.5, -0.5], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), plant="saturated")
    before = r.get_poses()
    r.set_velocities(np.array([2, 0]), np.array([[0.1, 0.05], [0.0, 0.0]]))
    r.step()
    np.testing.assert_allclose((r.get_poses() - before)[0], [0.00165, 0.0, 0.0033], atol=1e-12)


def test_the_verdict_tells_the_worst_and_the_first(capsys: pytest.CaptureFixture[str]) -> None:
    """0.2 m/s for five steps from just within the floor: 0.030 m beyond it in the end, 0.004 m at first."""
    r = Robotarium(initial_conditions=np.array([[1.597], [0.0], [0.0]]), plant="saturated")
    for _ in range(5):
        r.get_poses()
        r.set_velocities([0], np.array([[0.2], [0.0]]))
        r.step()
    (violation,) = r.debug().violations
    assert violation.first.value == pytest.approx(0.0036)
    assert violation.worst.value == pytest.approx(0.03)
    said = "robot 0 leaves the floor by 0.030 m; worst at 0.17 s near (1.63, 0.00) m, first at 0.03 s, 5 steps"
    assert said in capsys.readouterr().out


def test_each_wheel_is_clipped_by_itself_and_that_is_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    r = Robotarium(initial_conditions=np.zeros((3, 1)), plant="saturated")
    limit = GTERNAL.drive.wheel_speed_limit
    r.get_poses()
    r.set_velocities([0], GTERNAL.drive.twist(np.array([[5.0, 3.0 * limit]])).T)
    r.step()
    turn = r.TIME_STEP * GTERNAL.drive.twist(np.array([5.0, limit]))[1]
    assert r.get_poses()[2, 0] == pytest.approx(turn)
    verdict = r.debug()
    assert verdict.accepted
    assert [violation.kind for violation in verdict.violations] == ["actuator"]
    printed = capsys.readouterr().out
    assert "WARNING: robot 0" in printed
    assert "37.5 rad/s" in printed


def test_driving_off_the_floor_is_not_hidden_by_a_wall(capsys: pytest.CaptureFixture[str]) -> None:
    r = Robotarium(initial_conditions=np.array([[1.55], [0.0], [0.0]]))
    r.get_poses()
    r.set_velocities([0], [[0.15], [0.0]])
    for _ in range(30):
        r.step()
        r.get_poses()
    assert not r.debug().accepted
    assert "ERROR: robot 0 leaves the floor" in capsys.readouterr().out


def test_the_verdict_is_the_judges_on_all_that_was_recorded(capsys: pytest.CaptureFixture[str]) -> None:
    r = Robotarium(initial_conditions=np.array([[-0.2, 0.2], [0.0, 0.0], [0.0, np.pi]]))
    r.get_poses()
    r.set_velocities([0, 1], [[0.15, 0.15], [0.0, 0.0]])
    for _ in range(60):
        r.step()
        r.get_poses()
    t, poses, wheel_speeds = r.recorded()
    assert r.call_at_scripts_end() == judge(t, poses, wheel_speeds)
    assert "robots 0 and 1 come within 0.135 m" in capsys.readouterr().out
    assert np.linalg.norm(np.diff(collision_centres(poses[-1]), axis=0)) > 0.09, "bodies do not pass through each other"


@given(st.floats(-50.0, 50.0))
def test_headings_are_given_within_half_a_turn(theta: float) -> None:
    r = Robotarium(initial_conditions=np.array([[0.0], [0.0], [theta]]), plant="saturated")
    heading = r.get_poses()[2, 0]
    assert -np.pi <= heading <= np.pi
    assert np.exp(1j * heading) == pytest.approx(np.exp(1j * theta))


@given(st.integers(1, 50), st.integers(0, 2**32))
def test_drawn_poses_are_apart_on_the_floor_and_the_seeds(n: int, seed: int) -> None:
    r = Robotarium(n, seed=seed, plant="saturated")
    t, poses, wheel_speeds = r.recorded()
    assert judge(t, poses, wheel_speeds).accepted
    assert poses.shape == (1, n, 3)
    assert (Robotarium(n, seed=seed, plant="saturated").get_poses() == r.get_poses()).all()


def test_poses_and_steps_alternate() -> None:
    r = Robotarium(2)
    with pytest.raises(RuntimeError, match="without get_poses"):
        r.step()
    r.get_poses()
    with pytest.raises(RuntimeError, match="called twice"):
        r.get_poses()
    r.step()
    with pytest.raises(RuntimeError, match="without get_poses"):
        r.step()


def test_what_get_poses_returns_is_the_callers() -> None:
    r = Robotarium(2, plant="saturated")
    r.get_poses()[:] = np.nan
    r.step()
    assert np.isfinite(r.get_poses()).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "number_of_robots"),
        ({"number_of_robots": 0}, "number_of_robots"),
        ({"number_of_robots": 51}, "number_of_robots"),
        ({"number_of_robots": 2, "plant": "pymonk"}, "plant must be one of unicycle, saturated, pymunk"),
        ({"number_of_robots": 2, "plant": "single_integrator"}, "plant"),
        ({"number_of_robots": 2, "initial_conditions": np.zeros((3, 3))}, r"shape \(3, 2\)"),
        ({"initial_conditions": np.zeros((2, 3))}, r"shape \(3, N\)"),
        ({"initial_conditions": np.full((3, 1), np.nan)}, "finite"),
    ],
)
def test_a_testbed_that_cannot_be_is_refused(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Robotarium(**arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("ids", "velocities", "words"),
    [
        ([0, 1], np.zeros((2, 3)), r"shape \(2, 2\)"),
        ([0, 1], np.zeros((3, 2)), r"shape \(2, 2\)"),
        ([2], np.zeros((2, 1)), "0..1"),
        ([-3], np.zeros((2, 1)), "0..1"),
        ([True, False, True], np.zeros((2, 2)), "0..1"),
        ([0.5], np.zeros((2, 1)), "0..1"),
        ([0, 1], np.array([[0.0, np.nan], [0.0, 0.0]]), "robot 1"),
    ],
)
def test_a_command_that_cannot_be_is_refused(ids: list[int], velocities: np.ndarray, words: str) -> None:
    r = Robotarium(2)
    with pytest.raises(ValueError, match=words):
        r.set_velocities(ids, velocities)


def test_an_empty_array_asks_for_drawn_poses_as_in_the_public_simulator() -> None:
    assert Robotarium(3, initial_conditions=np.array([])).get_poses().shape == (3, 3)


def test_the_certificate_keeps_robots_apart_that_are_sent_to_one_place() -> None:
    certificate = create_si_barrier_certificate_with_boundary(safety_radius=0.16, barrier_gain=1000.0)
    points = np.array([[-0.4, 0.4, 0.0], [0.0, 0.05, 0.4]])
    closest = np.inf
    for _ in range(600):
        points = points + 0.033 * certificate(-points, points)
        closest = min(closest, float(separation(points.T[None]).distance[0]))
    assert 0.16 <= closest < 0.25


def test_the_certificate_leaves_alone_what_is_safe() -> None:
    certificate = create_si_barrier_certificate_with_boundary()
    wish = np.array([[0.05, -0.1], [0.1, 0.05]])
    np.testing.assert_allclose(certificate(wish, np.array([[0.5, -0.5], [0.0, 0.0], [0.1, 0.2]])), wish, atol=1e-9)
