"""Rays, starts, sensors of motion, outlines and checked columns of the public interface, each by itself."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots.rps import columns, constants, distances, inertial, starts
from robots.rps.version2 import gternal_patch, misc

SEEDS = st.integers(0, 2**32 - 1)
REACH = 1.2


def marched(origin: np.ndarray, direction: np.ndarray, solid: object) -> float:
    """How far a ray goes until it is in something, in steps of two millimetres."""
    for distance in np.arange(0.0, REACH, 2e-3):
        if solid(origin + distance * direction):  # type: ignore[operator]
            return float(distance)
    return REACH


def placed(pose: np.ndarray, sensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction of one sensor of one robot."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    origin = pose[:2] + [c * sensor[0] - s * sensor[1], s * sensor[0] + c * sensor[1]]
    return origin, np.array([np.cos(pose[2] + sensor[2]), np.sin(pose[2] + sensor[2])])


@settings(max_examples=3)
@given(seed=SEEDS)
def test_a_ray_ends_at_the_nearest_line_or_disc_or_at_its_reach(seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = np.array([rng.uniform(-0.6, 0.6, 4), rng.uniform(-0.6, 0.6, 4), rng.uniform(-3.0, 3.0, 4)])
    sensors = np.array([[0.05, 0.0, -0.04], [0.0, 0.06, 0.04], [0.0, 1.5, 3.0]])
    lines = rng.uniform(-1.0, 1.0, (3, 2, 2))
    to_lines = distances.against_lines(poses, sensors, lines, REACH)
    to_discs = distances.against_discs(poses, sensors, 0.055, REACH)
    assert to_lines.shape == to_discs.shape == (3, 4)
    for robot in range(4):
        others = np.delete(poses[:2].T, robot, axis=0)
        for sensor in range(3):
            origin, direction = placed(poses[:, robot], sensors[:, sensor])
            if not (np.linalg.norm(others - origin, axis=1) < 0.06).any():
                disc = marched(origin, direction, lambda p, o=others: (np.linalg.norm(o - p, axis=1) < 0.055).any())
                assert to_discs[sensor, robot] == pytest.approx(disc, abs=0.02)
            best = REACH
            for a, b in lines:
                matrix = np.stack([direction, a - b], axis=1)
                along, share = np.linalg.solve(matrix, a - origin)
                if along >= 0.0 and 0.0 <= share <= 1.0:
                    best = min(best, along)
            assert to_lines[sensor, robot] == pytest.approx(best)
            ends = distances.endpoints(poses, sensors, to_lines)
            np.testing.assert_allclose(ends[:, sensor, robot], origin + best * direction)


def test_where_there_is_nothing_a_ray_goes_all_its_way_and_what_was_not_seen_has_no_end() -> None:
    poses, sensors = np.zeros((3, 2)) + [[0.0, 5.0]] * 3, constants.DISTANCE_SENSORS_ORIENTATION
    for nothing in (None, np.empty((0, 2, 2))):
        assert (distances.against_lines(poses, sensors, nothing, REACH) == REACH).all()
    assert (distances.against_discs(poses, sensors, 0.055, REACH) == REACH).all()
    assert (distances.against_discs(poses[:, :1], sensors, 0.055, REACH) == REACH).all()
    beside = np.array([[[0.0, 0.5], [1.0, 0.5]]])  # parallel to the ray ahead
    assert distances.against_lines(poses[:, :1] * 0.0, sensors, beside, REACH)[3, 0] == REACH
    ends = distances.endpoints(poses, sensors, np.full((7, 2), -1.0))
    assert np.isnan(ends).all()
    at_once = distances.endpoints(poses, sensors, np.zeros((7, 2)))
    np.testing.assert_allclose(at_once[:, 3, 0], [0.05, 0.0])


def test_random_starts_for_fifty_keep_collision_centres_apart_and_on_the_floor() -> None:
    for seed in range(10):
        poses = starts.scattered(50, starts.generator(seed))
        assert poses.shape == (50, 3)
        centres = poses[:, :2] + 0.025 * np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=1)
        gaps = np.linalg.norm(centres[:, None] - centres, axis=-1) + np.eye(50)
        assert gaps.min() > 0.15
        assert (np.abs(poses) <= [1.4, 0.85, np.pi]).all()
        assert (np.abs(poses[:, :2]).max(axis=0) > [1.3, 0.75]).all()
        np.testing.assert_allclose(poses[:, :2].mean(axis=0), 0.0, atol=0.03)
        assert (poses[:, :2].std(axis=0) > [0.7, 0.5]).all()
    few = starts.scattered(3, starts.generator(1))
    assert few.shape == (3, 3)
    np.testing.assert_array_equal(few, starts.scattered(3, starts.generator(1)))
    assert (few != starts.scattered(3, starts.generator(2))).any()


def test_near_starts_fill_the_tolerance_of_the_testbed_evenly() -> None:
    poses = np.tile([0.5, -0.2, 1.0], (8000, 1))
    off = starts.near(poses, np.random.default_rng(0)) - poses
    reach = np.hypot(off[:, 0], off[:, 1]) / 0.05
    assert 0.99 < reach.max() <= 1.0
    np.testing.assert_allclose(np.quantile(reach**2, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.03)
    np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=4e-3)
    assert 0.199 < np.abs(off[:, 2]).max() <= 0.2
    assert off[:, 2].std() == pytest.approx(0.2 / np.sqrt(3.0), rel=0.03)


@pytest.mark.parametrize(
    ("number", "given", "expected"),
    [
        (3, None, (3, None)),
        (5, np.empty((3, 0)), (5, None)),
        (-1, np.zeros((3, 4)), (4, (4, 3))),
        (2, np.ones((3, 2)), (2, (2, 3))),
        (50, None, (50, None)),
        (1, None, (1, None)),
    ],
)
def test_robots_are_as_many_as_are_told_or_as_poses_are_given(
    number: int, given: np.ndarray | None, expected: tuple[int, tuple[int, int] | None]
) -> None:
    n, poses = starts.given_poses(number, given)
    assert (n, None if poses is None else poses.shape) == expected


@pytest.mark.parametrize(
    ("number", "given", "message"),
    [
        (2, np.zeros((2, 2)), r"initial_conditions must have the shape \(3, N\), got \(2, 2\)"),
        (2, np.zeros(3), r"initial_conditions must have the shape \(3, N\), got \(3,\)"),
        (2, np.zeros((3, 4)), r"initial_conditions must have the shape \(3, 2\), got \(3, 4\)"),
        (2, np.full((3, 2), np.nan), "initial_conditions must be finite"),
        (0, None, "number_of_robots must be 1 to 50, got 0"),
        (51, None, "number_of_robots must be 1 to 50, got 51"),
        (-1, None, "number_of_robots must be 1 to 50, got -1"),
    ],
)
def test_starts_that_make_no_sense_are_refused(number: int, given: np.ndarray | None, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        starts.given_poses(number, given)


def test_a_place_to_drive_to_first_is_within_a_quarter_metre_and_on_the_floor() -> None:
    state = np.random.get_state()  # noqa: NPY002
    np.random.seed(3)  # noqa: NPY002
    try:
        found = np.array([starts._nearby(np.array([1.5, -0.9]), np.array([-1.6, 1.6, -1.0, 1.0])) for _ in range(2000)])
    finally:
        np.random.set_state(state)  # noqa: NPY002
    np.testing.assert_allclose(found.min(axis=0), [1.25, -1.0, -np.pi], atol=0.01)
    np.testing.assert_allclose(found.max(axis=0), [1.6, -0.65, np.pi], atol=0.01)


class Drawn:
    """Draws that are all the same number."""

    def __init__(self, value: float) -> None:
        self.value, self.asked = value, 0

    def standard_normal(self, shape: tuple[int, ...]) -> np.ndarray:
        self.asked += int(np.prod(shape))
        return np.full(shape, self.value)


def test_readings_are_what_is_true_plus_deviations_times_draws() -> None:
    motion = np.array([[0.1, 0.5], [0.0, -1.0]])
    theta = np.array([0.3, 4.0])
    for value in (0.0, 1.0, -2.0):
        readings = inertial.Readings(2)
        assert not any(np.any(each) for each in (readings.encoders, readings.accelerations, readings.gyros))
        assert readings.encoders.shape == (2, 2)
        assert readings.accelerations.shape == readings.magnetic_fields.shape == (3, 2)
        assert readings.orientations.tolist() == [0.0, 0.0]
        draws = Drawn(value)
        readings.measure(motion, theta, draws)
        assert draws.asked == 20
        felt = inertial.at_sensor(motion / 0.033, motion[:, 1])
        np.testing.assert_allclose(readings.accelerations, felt + value * constants.ACCELEROMETER_NOISE_STDS[:, None])
        turning = np.array([[0.0, 0.0], [0.0, 0.0], motion[:, 1]])
        np.testing.assert_allclose(readings.gyros, turning + value * constants.GYRO_NOISE_STDS[:, None])
        field = np.array([6.0712 * np.cos(theta), -6.0712 * np.sin(theta), [-39.8594] * 2])
        np.testing.assert_allclose(readings.magnetic_fields, field + value * constants.MAGNETOMETER_NOISE_STDS[:, None])
        degrees = (np.degrees(theta) + 0.31083 * value) % 360.0
        np.testing.assert_allclose(readings.orientations, degrees)
        readings.measure(motion, theta, Drawn(0.0))  # the same again: no acceleration
        np.testing.assert_allclose(readings.accelerations, inertial.at_sensor(0.0 * motion, motion[:, 1]))


def test_encoders_count_on_with_noise_of_the_root_of_what_they_count() -> None:
    turned = np.array([[1.0, -2.0], [0.0, 1e-4]])
    readings = inertial.Readings(2)
    counts = turned.T * 28 * 100.37 / (2.0 * np.pi)
    for value in (2.0, 0.0):
        readings.count(turned, Drawn(value))
    noisy = np.round(counts + 2.0 * 0.25 * np.sqrt(np.maximum(np.abs(counts), 1.0)))
    np.testing.assert_array_equal(readings.encoders, noisy + np.round(counts))


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_the_outline_of_a_robot_has_its_sizes_ahead_of_its_axle() -> None:
    data = gternal_patch.gternal_patch()
    body, left, right, lamp = (data.vertices[face] for face in data.faces)
    assert sum(len(face) for face in data.faces) == len(data.vertices)
    assert body[:, 1].min() == -0.016
    assert body[:, 1].max() == pytest.approx(0.095 - 0.016, abs=1e-3)  # the arch has no point at its very top
    everything = data.vertices
    assert everything[:, 0].min() == pytest.approx(-0.059)
    assert everything[:, 0].max() == pytest.approx(0.059)
    for wheel, side in ((left, -1.0), (right, 1.0)):
        np.testing.assert_allclose(np.ptp(wheel, axis=0), [0.008, 0.032])
        np.testing.assert_allclose(wheel.mean(axis=0), [side * 0.055, 0.0], atol=1e-15)
    np.testing.assert_allclose(np.ptp(lamp, axis=0), [0.016, 0.016])
    assert (np.abs(lamp[:, 0]) < 0.051).all()
    half = 0.051
    straight = 2.0 * half * (0.095 - half)
    assert area(body) == pytest.approx(straight + np.pi * half**2 / 2.0, rel=0.01)
    assert len(data.colors) == 4


def test_a_drawn_robot_stands_at_its_pose_looks_ahead_and_lights_its_lamp() -> None:
    drawn: list[object] = []
    axes = SimpleNamespace(add_patch=drawn.append)
    patch = gternal_patch.GTERNALRobotPatch(axes, [1.0, 2.0, 0.0])  # type: ignore[arg-type]
    data = gternal_patch.gternal_patch()
    assert drawn == patch._patches
    for pose in ([1.0, 2.0, 0.0], [-0.5, 0.3, 2.0]):
        patch.set_pose(pose)
        x, y, theta = pose
        for face, shown in zip(data.faces, patch._patches, strict=True):
            right, ahead = data.vertices[face].T
            expected = complex(x, y) + (ahead - 1j * right) * np.exp(1j * theta)
            xy = shown.get_xy()[: len(face)]
            np.testing.assert_allclose(xy @ (1.0, 1j), expected, atol=1e-12)
    patch.set_led([255, 51, 0])
    assert patch._patches[3].get_facecolor() == pytest.approx((1.0, 0.2, 0.0, 1.0))
    np.testing.assert_allclose(patch._patches[0].get_facecolor()[:3], np.array([179, 163, 105]) / 255.0)
    patch.set_zorder(7.0)
    assert {each.get_zorder() for each in patch._patches} == {7.0}


@given(seed=SEEDS, distance=st.floats(0.01, 0.2), limit=st.floats(0.0, 3.0))
def test_columns_are_turned_carried_ahead_and_shortened_robot_by_robot(
    seed: int, distance: float, limit: float
) -> None:
    rng = np.random.default_rng(seed)
    vectors, states = rng.normal(size=(2, 4)), rng.normal(size=(3, 4))
    turn = np.exp(1j * states[2])
    z = vectors[0] + 1j * vectors[1]
    parts = columns.along(vectors, states[2])
    np.testing.assert_allclose(parts[0] + 1j * parts[1], z / turn)
    np.testing.assert_allclose(columns.across(parts, states[2]), vectors)
    ahead = columns.ahead(states, distance)
    np.testing.assert_allclose(ahead[0] + 1j * ahead[1], states[0] + 1j * states[1] + distance * turn)
    short = columns.limited(vectors, limit)
    expected = z * np.minimum(1.0, limit / np.abs(z))
    np.testing.assert_allclose(short[0] + 1j * short[1], expected, atol=1e-15)
    assert columns.wrapped(np.array([7.0, -4.0])) == pytest.approx([7.0 - 2.0 * np.pi, 2.0 * np.pi - 4.0])


def test_columns_and_numbers_that_make_no_sense_are_refused_by_name() -> None:
    assert columns.columns("x", [[1, 2]], 1).shape == (1, 2)
    for array, rows, n in ((np.zeros((2, 3)), 3, None), (np.zeros(3), 3, None), (np.zeros((3, 2)), 3, 4)):
        with pytest.raises(ValueError, match=rf"x must have the shape \({rows}, {n or 'N'}\)"):
            columns.columns("x", array, rows, n)
    columns.positive(gain=1e-9, other=np.float64(2.0))
    columns.not_negative(gain=0, other=0.0)
    columns.whole(2, count=2, other=np.int64(3))
    for check, bad in (
        (columns.positive, 0.0),
        (columns.positive, "1"),
        (columns.not_negative, -1e-9),
        (columns.not_negative, None),
    ):
        with pytest.raises(ValueError, match="gain must be a"):
            check(gain=bad)  # type: ignore[operator]
    for bad in (1, 2.0):
        with pytest.raises(ValueError, match="count must be a whole number from 2 on"):
            columns.whole(2, count=bad)  # type: ignore[arg-type]


def test_who_is_exactly_as_far_off_as_is_allowed_has_arrived() -> None:
    states, goals = np.array([[0.25, 0.5], [0.0, 0.0], [0.5, 0.0]]), np.zeros((3, 2))
    assert misc.create_at_position(0.25)(states, goals[:2])[1].tolist() == [True, False]
    assert misc.create_at_pose(0.25, 0.5)(states, goals)[1].tolist() == [True, False]
