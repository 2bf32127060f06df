"""The robots themselves: both generations' attributes, edge cases of commands, sensors, and how they hold a pose."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots.rps import constants, hook, inertial
from robots.rps.session import Session, during
from robots.rps.version1.robotarium import Robotarium as First
from robots.rps.version2.controllers import create_pose_controller_clf
from robots.rps.version2.robotarium import Robotarium as Second

THREE = np.array([[0.0, 0.5, -0.5], [0.0, 0.2, -0.2], [0.0, 1.0, -2.0]])


def made(plant: str = "saturated", poses: np.ndarray = THREE, **arguments: Any) -> Second:
    return Second(initial_conditions=poses, plant=plant, seed=0, **arguments)


def drive(robots: Any, command: np.ndarray, steps: int) -> None:
    for _ in range(steps):
        robots.get_poses()
        robots.set_velocities(slice(None), command)
        robots.step()


@pytest.mark.parametrize(
    ("ids", "picked"),
    [
        ([0, 2], [0, 2]),
        (-1, [2]),
        (slice(0, 2), [0, 1]),
        (np.array([True, False, True]), [0, 2]),
        (range(3), [0, 1, 2]),
    ],
)
def test_ids_are_whatever_picks_columns(ids: object, picked: list[int]) -> None:
    robots = made()
    robots.get_poses()
    robots.set_velocities(ids, np.array([[0.1], [0.5]]))
    expected = np.zeros((2, 3))
    expected[:, picked] = [[0.1], [0.5]]
    np.testing.assert_array_equal(robots._velocities, expected)


def test_version_one_cuts_commands_and_has_its_own_base() -> None:
    robots = First(number_of_agents=3, show_figure=False, initial_conditions=THREE, plant="saturated", seed=0)
    robots.get_poses()
    robots.set_velocities([0], np.array([[1.0], [-9.0]]))
    np.testing.assert_allclose(robots.velocities[:, 0], [0.2, -robots.max_angular_velocity])
    assert (robots.base_length, robots.number_of_agents, robots.boundaries[2]) == (0.105, 3, 3.2)
    robots.step()
    np.testing.assert_allclose(robots.poses, robots.get_poses())
    np.testing.assert_allclose(
        robots.poses, robots.get_poses(), err_msg="in 2018 poses were given as often as asked for"
    )
    turned = robots.poses[2, 0]
    wheels = np.array([0.2 + 0.0525 * 0.4 / 0.11, 0.2 - 0.0525 * 0.4 / 0.11]) / 0.016
    assert turned == pytest.approx(0.033 * 0.016 / 0.105 * np.diff(np.clip(wheels, -12.5, 12.5))[0])


def test_unknown_arguments_are_ignored_with_a_warning() -> None:
    with pytest.warns(UserWarning, match="no argument 'number_of_robts'"):
        made(number_of_robts=3)


@settings(max_examples=10)
@given(st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
def test_encoders_integrate_to_the_way_of_the_wheels(left: float, right: float) -> None:
    robots = made()
    v, omega = 0.008 * (left + right), 0.016 / 0.11 * (right - left)
    steps = 200
    drive(robots, np.tile([[v], [omega]], (1, 3)), steps)
    turned = np.array([[left], [right]]) * 0.033 * steps
    counts = turned * 28 * 100.37 / (2.0 * np.pi)
    each = np.maximum(np.abs(counts) / steps, 1.0)
    spread = np.sqrt(steps) * (0.25 * np.sqrt(each) + 0.5)
    assert (np.abs(robots.get_encoders() - counts) < 5.0 * spread).all()
    assert robots.get_encoders().dtype == np.int32


def test_sensors_have_the_published_deviations_about_what_is_true() -> None:
    n, steps = 12, 400
    poses = np.zeros((3, n))
    poses[0] = np.linspace(-60.0, 60.0, n)  # far apart, and turning in place
    robots = made(poses=poses)
    omega = 1.5
    read: dict[str, list[np.ndarray]] = {"gyro": [], "acc": [], "field": [], "turn": []}
    for step in range(steps):
        x = robots.get_poses()
        robots.set_velocities(np.arange(n), np.tile([[0.0], [omega]], (1, n)))
        robots.step()
        if step > 1:
            theta = x[2] + 0.033 * omega
            read["gyro"].append(robots.get_gyros() - [[0.0], [0.0], [omega]])
            px, py, _ = constants.IMU_ORIENTATION
            read["acc"].append(robots.get_accelerations() - [[-(omega**2) * px], [-(omega**2) * py], [-9.81]])
            north = 6.0712 * np.array([np.cos(theta), -np.sin(theta)])
            read["field"].append(robots.get_magnetic_fields() - np.array([*north, np.full(n, -39.8594)]))
            read["turn"].append((robots.get_orientations() - np.degrees(theta) + 180.0) % 360.0 - 180.0)
    for name, deviations in (
        ("gyro", constants.GYRO_NOISE_STDS),
        ("acc", constants.ACCELEROMETER_NOISE_STDS),
        ("field", constants.MAGNETOMETER_NOISE_STDS),
    ):
        errors = np.array(read[name])
        np.testing.assert_allclose(errors.std(axis=(0, 2)), deviations, rtol=0.05)
        assert (np.abs(errors.mean(axis=(0, 2))) < 5.0 * deviations / np.sqrt(errors[:, 0].size)).all()
    assert np.std(read["turn"]) == pytest.approx(constants.ORIENTATION_NOISE_STD, rel=0.05)


def test_accelerometers_read_acceleration_and_gravity() -> None:
    acceleration = np.array([[2.0, 0.0], [0.0, 3.0]])
    px, py, _ = constants.IMU_ORIENTATION
    np.testing.assert_allclose(
        inertial.at_sensor(acceleration, np.array([0.0, 0.0])).T, [[2.0, 0.0, -9.81], [-3.0 * py, 3.0 * px, -9.81]]
    )
    robots = made()
    drive(robots, np.tile([[0.2], [0.0]], (1, 3)), 1)
    np.testing.assert_allclose(robots.get_accelerations()[0], 0.2 / 0.033, atol=0.1)


def test_distances_are_the_geometrys_without_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISTANCE_SENSOR_ERROR", "DISTANCE_SENSOR_DROPOUT_PROB", "DISTANCE_SENSOR_OUTLIER_PROB"):
        monkeypatch.setattr(Second, name, 0.0)
    wall = np.array([[[1.0, -1.0], [1.0, 1.0]]])
    poses = np.array([[0.0, 0.0], [0.0, 0.5], [0.0, 0.0]])
    robots = made(poses=poses, use_distance_sensors=True, obstacles=wall)
    drive(robots, np.zeros((2, 2)), 1)
    distances = robots.get_distances()
    assert distances[3].tolist() == pytest.approx([1.0 - 0.01 - 0.05] * 2)  # ahead, to the wall
    assert distances[1, 0] == pytest.approx(0.5 - 0.06 - 0.055)  # to the left, to the other robot
    assert distances[5, 0] == -1.0
    ends = robots.get_distance_endpoints()
    np.testing.assert_allclose(ends[:, 3, 0], [0.05 + 0.94, 0.0])
    assert np.isnan(ends[:, 5, 0]).all()
    off = made(poses=poses)
    drive(off, np.zeros((2, 2)), 1)
    assert (off.get_distances() == -1.0).all()


def test_distances_of_version_one_are_the_same_up_to_its_frames() -> None:
    across = np.array([[[1.0, 1.0], [-1.0, 1.0]]])  # x of both ends, y of both ends
    first = First(
        initial_conditions=np.zeros((3, 1)), show_figure=False, use_distance_sensors=True, obstacles=across,
        plant="saturated", seed=0,
    )  # fmt: skip
    read = []
    for _ in range(400):
        first.get_poses()
        first.step()
        read.append(first.get_distances()[3, 0])
    seen = np.array(read)
    assert np.median(seen[seen > 0.0]) == pytest.approx(0.95, abs=0.01)
    assert (seen == -1.0).mean() == pytest.approx(0.035, abs=0.03)
    assert first.transform_distance_readings().shape == (2, 7)


def test_lamps_and_colours_are_there() -> None:
    robots = made()
    robots.set_leds([0, 1], np.array([[255, 0], [0, 255], [0, 0]]))
    np.testing.assert_array_equal(robots._leds, [[255, 0, 0], [0, 255, 0], [0, 0, 0]])
    assert len(robots.robot_colormap()(0)) == 4


def test_random_starts_come_from_the_global_generator(global_draws: Callable[[int], None]) -> None:
    starts = []
    for seed in (1, 1, 2):
        global_draws(seed)
        starts.append(Second(number_of_robots=5, plant="saturated").get_poses())
    np.testing.assert_array_equal(starts[0], starts[1])
    assert (starts[0] != starts[2]).any()
    assert Second(number_of_robots=50, plant="saturated").get_poses().shape == (3, 50)


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_robots_come_to_a_pose_and_hold_it(plant: str) -> None:
    """On ``pymunk`` the axle of a robot that turned was carried forward, and near its goal it spun for ever."""
    goals = np.array([[0.8, -0.8, 0.0], [0.4, 0.4, -0.6], [2.0, -1.0, 0.5]])
    robots, controller = made(plant), create_pose_controller_clf()
    for _ in range(700):
        x = robots.get_poses()
        robots.set_velocities(np.arange(3), controller(x, goals))
        robots.step()
    poses = robots.record().poses[350:]
    off = np.hypot(poses[..., 0] - goals[0], poses[..., 1] - goals[1])
    turned = np.abs(np.angle(np.exp(1j * (poses[..., 2] - goals[2]))))
    assert ((off < 0.05) & (turned < 0.2)).mean() > 0.5


def test_the_axle_of_a_robot_that_spins_in_place_stays_there() -> None:
    robots = made("pymunk", THREE[:, :1])
    drive(robots, np.array([[0.0], [3.0]]), 300)
    off = robots.record().poses[:, 0, :2] - THREE[:2, 0]
    assert np.hypot(*off.T).max() < 5e-5


@pytest.mark.parametrize("version", [1, 2])
def test_the_hook_serves_all_modules_and_puts_back_what_was_there(version: Any) -> None:
    import sys

    stranger = type(sys)("rps")
    sys.modules["rps"] = stranger
    try:
        with hook.serving(version):
            import rps  # type: ignore[import-not-found]

            assert rps is not stranger
            assert rps.__version__ == hook.PUBLISHED[version]
            for rest in hook.MODULES:
                module = __import__(f"rps.{rest}", fromlist=["x"])
                assert set(hook.names(rest, version)) <= set(vars(module))
            from rps.utilities.controllers import create_si_position_controller, create_uni_to_si_mapping  # noqa: F401

            with pytest.raises(ModuleNotFoundError, match=r"rps\.nonsense'; known: rps\.robotarium"):
                import rps.nonsense  # type: ignore[import-not-found]
        gain = {1: 0.1, 2: 0.08}[version]
        goal = create_si_position_controller()(np.zeros((2, 1)), np.full((2, 1), 0.1))
        np.testing.assert_allclose(goal, gain)
        assert sys.modules["rps"] is stranger
        assert "rps.robotarium" not in sys.modules
    finally:
        del sys.modules["rps"]


@pytest.mark.parametrize("version", [1, 2])
def test_names_that_come_along_are_of_the_generation_that_is_served(version: Any) -> None:
    """In version 1 the mapping cuts the turn; that of 2, which ``controllers`` uses, does not."""
    mapping = hook.names("utilities.transformations", version)
    for module in hook.ALSO:
        along = hook.names(module, version)
        assert {name: along[name] for name in mapping} == mapping


def test_a_session_says_how_robots_are_simulated_and_watches_them() -> None:
    seen: list[int] = []
    session = Session(plant="saturated", begun=lambda r: seen.append(-1), stepped=lambda r: seen.append(r.steps))
    with during(session):
        robots = Second(initial_conditions=THREE, seed=0)
        drive(robots, np.zeros((2, 3)), 2)
    assert seen == [-1, 1, 2]


def test_the_figure_shows_robots_where_they_are_when_it_is_drawn() -> None:
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    robots = made(use_distance_sensors=True, show_distance_rays=True, obstacles=np.array([[[1.0, -1.0], [1.0, 1.0]]]))
    axes, figure = robots._axes_handle, robots._fig
    picture = robots.picture
    assert picture is not None
    assert not picture.used()
    drive(robots, np.tile([[0.1], [0.0]], (1, 3)), 30)
    figure.canvas.draw()
    body = picture.chassis[0]._patches[0].get_xy()
    assert body[:, 0].max() == pytest.approx(30 * 0.0033 + 0.095 - 0.016, abs=1e-3)
    axes.text(0, 0, "x")
    assert picture.used()
    plt.close(figure)
