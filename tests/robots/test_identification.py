"""Logs of robots: what is told from them, what is repaired, what is refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robots.identification.check import COUNTER_RANGE, checked
from robots.identification.estimate import Identified, identify
from robots.identification.log import LogError
from robots.identification.numbers import NAMES, RobotNumbers, share
from robots.identification.reading import read_arrays
from robots.identification.reckoning import dead_reckoning
from robots.identification.synthetic import random_truth, random_way, synthesise
from robots.measured import MEASURED

TURNS = 1500
SILENT = replace(
    MEASURED.numbers,
    **dict.fromkeys(
        ("jitter", "position_noise", "heading_noise", "slip_along", "slip_heading", "slip_turning", "missing", "stale"),
        0.0,
    ),
)

Arrays = tuple[np.ndarray, np.ndarray]


def synthetic(truth: RobotNumbers, seed: int = 3, turns: int = TURNS) -> Arrays:
    rng = np.random.default_rng(seed)
    return synthesise(random_way(rng, turns), truth, rng)


@pytest.fixture(scope="module")
def raw() -> Arrays:
    return synthetic(MEASURED.numbers)


@pytest.fixture(scope="module")
def found(raw: Arrays) -> Identified:
    return identify(checked(*raw))


def test_every_number_of_a_synthetic_robot_lies_within_twice_its_interval(found: Identified) -> None:
    for name in NAMES:
        interval, truth = found.intervals[name], getattr(MEASURED.numbers, name)
        half = max(interval.high - interval.value, interval.value - interval.low)
        assert abs(interval.value - truth) < 2.0 * half, name


def test_a_noise_that_the_log_tells_from_none_has_an_interval_about_it_in_shares(found: Identified) -> None:
    for name in ("jitter", "slip_turning", "slip_heading"):
        interval = found.intervals[name]
        assert 0.0 < interval.low < interval.value < interval.high
        assert interval.value**2 == pytest.approx(interval.low * interval.high)


def test_whitened_residuals_are_white(found: Identified) -> None:
    white = found.residuals[np.isfinite(found.residuals[:, 0])]
    assert np.allclose(white.std(axis=0), 1.0, atol=0.06)
    assert np.abs((white[1:] * white[:-1]).mean(axis=0)).max() < 0.08


def test_longer_logs_give_narrower_intervals() -> None:
    truth = random_truth(np.random.default_rng(5))
    widths = [
        np.diff([(i.low, i.high) for i in identify(checked(*synthetic(truth, 5, turns))).intervals.values()]).ravel()
        for turns in (600, 2400)
    ]
    assert np.median(widths[1] / widths[0]) == pytest.approx(0.5, abs=0.15)  # by the root of four times the turns


@pytest.mark.slow
def test_intervals_hold_the_truth() -> None:
    held = []
    for seed in range(20):
        rng = np.random.default_rng(1000 + seed)
        truth = random_truth(rng)
        found = identify(checked(*synthesise(random_way(rng, 1200), truth, rng)))
        held.append([found.intervals[name].holds(getattr(truth, name)) for name in NAMES])
    assert np.mean(held) == pytest.approx(0.95, abs=0.05)
    assert np.mean(held, axis=0).min() > 0.7


def test_true_numbers_reckon_better_than_the_data_sheet(found: Identified) -> None:
    numbers = found.numbers
    true = dead_reckoning(found.log, numbers.wheel_radius, numbers.base_length, numbers.lag)
    nominal = dead_reckoning(found.log, 0.016, 0.11, 1.0, spread=False)
    assert nominal.heading > 1.3 * true.heading
    assert nominal.position > 1.2 * true.position


def test_a_robot_without_noise_is_reckoned_exactly() -> None:
    log = checked(*synthetic(SILENT))
    offset = complex(SILENT.offset_ahead, SILENT.offset_left)
    errors = dead_reckoning(log, SILENT.wheel_radius, SILENT.base_length, SILENT.lag, offset, SILENT.marker_angle)
    assert errors.position < 2e-4  # rounding of headings and counts, and of the way between two turns
    assert errors.heading < 2e-3


def test_wilson_interval_of_a_share() -> None:
    interval = share(19, 100)
    assert (interval.value, interval.low, interval.high) == pytest.approx((0.19, 0.1253, 0.2774), abs=1e-3)
    assert share(0, 100).low == 0.0


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda p, c: (p, c[:, ::-1]), "exchanged"),
        (lambda p, c: (p, -c), "backwards"),
        (lambda p, c: (np.column_stack([p[:, :2], np.degrees(p[:, 2])]), c), "degrees"),
        (lambda p, c: (p, (c + 30_000) % COUNTER_RANGE - 32_768), "wrap"),
        (lambda p, c: (np.where(np.arange(len(p))[:, None] % 50 == 7, np.nan, p), c), "no poses"),
        (lambda p, c: (p, np.where(np.arange(len(c))[:, None] % 40 == 9, np.nan, c)), "no counts"),
    ],
    ids=["left and right", "signs", "degrees", "16 bits", "poses missing", "counts missing"],
)
def test_what_is_plain_to_see_is_repaired_and_said(
    raw: Arrays, found: Identified, spoil: Callable[[np.ndarray, np.ndarray], Arrays], said: str
) -> None:
    log = checked(*spoil(*raw))
    assert any(said in repair for repair in log.repairs)
    again = identify(log)
    for name in ("wheel_radius", "base_length", "offset_ahead", "lag"):
        one, other = again.intervals[name], found.intervals[name]
        assert one.value == pytest.approx(other.value, abs=other.high - other.low), name


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda p, c: (p[:, [1, 0, 2]], c), "columns look like y, x, theta"),
        (lambda p, c: (p[:, [2, 0, 1]], c), "jumps|columns look like theta, x, y"),
        (lambda p, c: (p, np.column_stack([c[:, 0], -c[:, 1]])), "one encoder counts backwards"),
        (lambda p, c: (p, c[::-1]), "disagree"),
        (lambda p, c: (np.vstack([p[:700], p[700:] + [0.9, 0.0, 0.0]]), c), "jumps by 0.9"),
        (lambda p, c: (p, np.vstack([c[:700], c[700:] + 31_000])), "counts jump"),
        (lambda p, c: (1000.0 * p, c), "metres"),
        (lambda p, c: (p, 0.0 * c), "never change"),
        (lambda p, c: (p[:100], c[:100]), "at least 200 turns"),
        (lambda p, c: (p[:, :2], c), r"expected poses \(T, 3\)"),
    ],
    ids=["x and y", "order", "one sign", "other robot", "mixed", "reset", "millimetres", "dead", "short", "shape"],
)
def test_what_cannot_be_used_is_refused_in_one_line(
    raw: Arrays, spoil: Callable[[np.ndarray, np.ndarray], Arrays], said: str
) -> None:
    with pytest.raises(LogError, match=said) as refused:
        checked(*spoil(*raw))
    assert "\n" not in str(refused.value)


def test_poses_of_one_robot_with_the_counts_of_another_are_refused(raw: Arrays) -> None:
    other = synthetic(MEASURED.numbers, seed=4)
    with pytest.raises(LogError, match="different robots"):
        checked(raw[0], other[1])


def test_a_robot_that_only_stands_is_refused() -> None:
    rng = np.random.default_rng(0)
    way = random_way(rng, 400)
    poses, counts = synthesise(replace(way, forward=0.01 * way.forward, turn=0.01 * way.turn), MEASURED.numbers, rng)
    with pytest.raises(LogError):
        identify(checked(poses, counts))


@pytest.mark.parametrize("form", ["npz", "npy", "csv", "mat", "folder", "columns first", "several robots"])
def test_files_of_every_form_hold_the_same_log(raw: Arrays, form: str, tmp_path: Path) -> None:
    from scipy.io import savemat

    poses, counts = raw
    path, robot = tmp_path / "log", 1
    match form:
        case "npz":
            np.savez(path := path.with_suffix(".npz"), poses=poses, counts=counts)
        case "npy":
            np.save(path := path.with_suffix(".npy"), np.column_stack([poses, counts]))
        case "csv":
            path = path.with_suffix(".csv")
            table = np.column_stack([counts, poses])
            np.savetxt(path, table, delimiter=",", header="left,right,x,y,theta", comments="", fmt="%.17g")
        case "mat":
            savemat(path := path.with_suffix(".mat"), {"poses": poses.T, "encoders": counts.T})
        case "folder":
            path.mkdir()
            np.save(path / "gt_trajectories.npy", poses[:, :, None])
            np.save(path / "encoder_readings.npy", counts[:, :, None].astype(np.int32))
        case "columns first":
            np.savez(path := path.with_suffix(".npz"), poses=poses.T, counts=counts.T)
        case "several robots":
            two = np.stack([0.0 * poses, poses], axis=2), np.stack([0.0 * counts, counts], axis=2)
            np.savez(path := path.with_suffix(".npz"), poses=two[0], counts=two[1])
            robot = 2
    read = read_arrays(path, robot)
    assert np.array_equal(read[0], poses)
    assert np.array_equal(read[1], counts)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("log.txt", b"", "expected a folder"),
        ("log.csv", b"x,y\n1,2\n", "theta is missing"),
        ("log.csv", b"x,y,theta,left,right\n1,2,3,4,five\n", "line 2: right: expected a number"),
        ("log.npz", b"no archive", "cannot be read"),
        ("log.mat", b"no matrix", "cannot be read"),
    ],
)
def test_a_file_that_is_no_log_is_refused(name: str, content: bytes, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(LogError, match=said):
        read_arrays(tmp_path / name)


def test_an_archive_without_poses_says_what_it_has(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", places=np.zeros((300, 3)))
    with pytest.raises(LogError, match=r"no array of poses: .* got places"):
        read_arrays(tmp_path / "log.npz")
