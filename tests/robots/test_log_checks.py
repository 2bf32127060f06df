"""What a log's check repairs, trims and refuses, with the numbers that it says."""

import re
from pathlib import Path

import numpy as np
import pytest

from robots.identification import check
from robots.identification.check import checked
from robots.identification.log import LogError
from robots.identification.reading import TIMES, read_all, read_arrays
from robots.identification.synthetic import random_way, synthesise
from robots.measured import MEASURED

TURNS = 300


@pytest.fixture(scope="module")
def raw() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return synthesise(random_way(rng, TURNS), MEASURED.numbers, rng)


def test_turns_without_a_value_are_counted_and_those_before_the_first_whole_one_left_out(
    raw: tuple[np.ndarray, np.ndarray],
) -> None:
    poses, counts = raw[0].copy(), raw[1].copy()
    poses[[0, 1, 50, 51, 90]], counts[[2, 60], 1] = np.nan, np.inf
    log = checked(poses, counts)
    assert log.repairs[:2] == (
        "5 of 300 turns have no poses: taken as lost messages",
        "2 of 300 turns have no counts: taken as lost messages",
    )
    assert log.turns == TURNS - 3
    assert np.flatnonzero(np.isnan(log.poses[:, 0])).tolist() == [47, 48, 87]
    assert np.flatnonzero(np.isnan(log.counts[:, 0])).tolist() == [57]
    clean = checked(*raw)
    assert clean.repairs == ()
    np.testing.assert_array_equal(clean.poses[:, :2], raw[0][:, :2])
    np.testing.assert_allclose(clean.poses[:, 2], np.unwrap(raw[0][:, 2]))
    np.testing.assert_array_equal(clean.counts, raw[1])
    assert clean.heading_quantum == 0.001


@pytest.mark.parametrize(("turns", "enough"), [(200, True), (199, False)])
def test_two_hundred_whole_turns_are_enough(raw: tuple[np.ndarray, np.ndarray], turns: int, enough: bool) -> None:
    poses, counts = raw[0][20 : 20 + turns], raw[1][20 : 20 + turns]
    if enough:
        assert checked(poses, counts).turns == 200
    else:
        with pytest.raises(LogError, match="expected at least 200 turns with poses and counts, got 199"):
            checked(poses, counts)


def test_counters_of_16_bits_are_made_continuous_and_their_wraps_counted(raw: tuple[np.ndarray, np.ndarray]) -> None:
    shifted = raw[1] - np.rint(raw[1].mean(axis=0))
    wrapped = np.mod(shifted, 65_536.0)
    wraps = int(np.abs(np.rint(np.diff(wrapped, axis=0) / 65_536.0)).sum())
    assert wraps > 0
    log = checked(raw[0], wrapped)
    assert log.repairs == (f"16-bit counters wrap {wraps} times: made continuous",)
    np.testing.assert_allclose(np.diff(log.counts, axis=0), np.diff(raw[1], axis=0))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda p, c: (p, c * [0.0, 1.0]), "the left encoder's counts never change, expected wheels that turn"),
        (lambda p, c: (p, c * [1.0, 0.0]), "the right encoder's counts never change, expected wheels that turn"),
        (lambda p, c: (100.0 * p, c), "positions reach"),
        (lambda p, c: (p[:, :2], c), "expected poses (T, 3) and counts (T, 2), got (300, 2) and (300, 2)"),
        (lambda p, c: (p, c[:-1]), "expected poses (T, 3) and counts (T, 2), got (300, 3) and (299, 2)"),
        (lambda p, c: (p[:, 0], c), "expected poses (T, 3) and counts (T, 2), got (300,) and (300, 2)"),
    ],
)
def test_what_is_refused_is_said_with_what_was_found(
    raw: tuple[np.ndarray, np.ndarray], spoil: object, said: str
) -> None:
    with pytest.raises(LogError, match=re.escape(said)):
        checked(*spoil(*raw))  # type: ignore[operator]


def test_a_jump_is_told_with_its_size_and_its_turn(raw: tuple[np.ndarray, np.ndarray]) -> None:
    after = np.arange(TURNS)[:, None] >= 123
    still = raw[0].copy()
    still[:, :2] = still[:1, :2]
    with pytest.raises(LogError, match=r"^the robot jumps by 0\.60 m at turn 123, expected less than 0\.25 m"):
        check._check_positions(still + after * [0.6, 0.0, 0.0])
    check._check_positions(still + after * [0.24, 0.0, 0.0])
    lost = still + after * [0.6, 0.0, 0.0]
    lost[121:123] = np.nan  # three turns from one pose to the next
    check._check_positions(lost)
    counts = np.cumsum(np.ones((TURNS, 2)), axis=0) + after * [0.0, 31_000.0]
    with pytest.raises(LogError, match=r"^the counts jump by 31001 at turn 123, expected a few times 371"):
        check._continuous(counts, [])
    allowed = np.cumsum(np.ones((TURNS, 2)), axis=0) + after * [0.0, 41.0 * 371.0]
    np.testing.assert_array_equal(check._continuous(allowed.copy(), []), allowed)


def test_degrees_signs_and_sides_are_put_right_one_by_one_and_together(raw: tuple[np.ndarray, np.ndarray]) -> None:
    poses, counts = raw
    clean = checked(poses, counts)
    degrees = np.column_stack([poses[:, :2], np.degrees(poses[:, 2])])
    log = checked(degrees, -counts[:, ::-1])
    assert log.repairs == (
        "headings are in degrees: converted",
        "both encoders count backwards: signs turned round",
        "left and right encoder are exchanged: put right",
    )
    np.testing.assert_allclose(log.poses, clean.poses)
    np.testing.assert_array_equal(log.counts, clean.counts)
    assert checked(poses, counts[:, ::-1]).repairs == ("left and right encoder are exchanged: put right",)
    assert checked(poses, -counts).repairs == ("both encoders count backwards: signs turned round",)


def test_a_pose_without_counts_has_the_heading_next_to_its_neighbours(raw: tuple[np.ndarray, np.ndarray]) -> None:
    counts = raw[1].copy()
    counts[[80, 81, 200]] = np.nan
    log, clean = checked(raw[0], counts), checked(*raw)
    np.testing.assert_allclose(log.poses[[80, 81, 200]], clean.poses[[80, 81, 200]])


def saved(folder: Path, **arrays: np.ndarray) -> Path:
    np.savez(folder / "log.npz", **arrays)
    return folder / "log.npz"


def test_times_are_read_where_a_file_has_them_and_have_to_grow(
    raw: tuple[np.ndarray, np.ndarray], tmp_path: Path
) -> None:
    poses, counts = raw
    times = np.cumsum(np.full(TURNS, 0.07))
    name = TIMES[0]
    read = read_all(saved(tmp_path, poses=poses, counts=counts, **{name: times}))
    assert read.times is not None
    np.testing.assert_array_equal(read.times, times)
    assert read.robots == 1
    assert read_all(saved(tmp_path, poses=poses, counts=counts)).times is None
    still = times.copy()
    still[7] = still[6]
    for bad in (times[:-1], times[::-1], still):
        with pytest.raises(LogError, match=rf"expected 300 times that grow, one for every pose, got {len(bad)}"):
            read_all(saved(tmp_path, poses=poses, counts=counts, **{name: bad}))


def test_what_does_not_belong_together_is_not_read(raw: tuple[np.ndarray, np.ndarray], tmp_path: Path) -> None:
    poses, counts = raw
    with pytest.raises(LogError, match="expected as many poses as counts, got 300 and 299"):
        read_all(saved(tmp_path, poses=poses, counts=counts[:-1]))
    with pytest.raises(LogError, match="no array of encoder counts"):
        read_arrays(saved(tmp_path, poses=poses))
    two = np.stack([poses, poses], axis=2)
    with pytest.raises(LogError, match="expected counts of 2 robots, as poses, got 1"):
        read_arrays(saved(tmp_path, poses=two, counts=counts[..., None]))
    both = saved(tmp_path, poses=two, counts=np.stack([counts, 2.0 * counts], axis=2))
    np.testing.assert_array_equal(read_arrays(both, 2)[1], 2.0 * counts)
    for robot in (0, 3):
        with pytest.raises(LogError, match=f"expected a robot from 1 to 2, got {robot}"):
            read_arrays(both, robot)
    with pytest.raises(LogError, match="no such file"):
        read_all(tmp_path / "other.npz")
    with pytest.raises(LogError, match=r"poses: expected 3 values a turn, got the shape \(300, 4, 1\)|got the shape"):
        read_all(saved(tmp_path, poses=np.zeros((300, 4)), counts=counts))
    with pytest.raises(LogError, match="poses: expected numbers, got <U1"):
        read_all(saved(tmp_path, poses=np.full((300, 3), "x"), counts=counts))
