"""Reading a log from a file, as people keep them: numpy's archives and folders of arrays, CSV, MATLAB's .mat."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots.identification.log import LogError

Real = NDArray[np.float64]

POSES = ("poses", "gt_trajectories", "trajectory", "trajectories", "x", "pose", "robot_poses")
"""Names of an array of poses, in any case; the first one found is taken."""

COUNTS = ("counts", "encoder_readings", "encoders", "encoder", "encoder_counts", "wheel_counts")
"""Names of an array of encoder counts, likewise."""

TIMES = ("t", "time", "times")
"""Names of an array of times, seconds, likewise."""

_COLUMNS = ("x", "y", "theta", "left", "right")
SUFFIXES = (".npz", ".npy", ".csv", ".mat")


@dataclass(frozen=True, eq=False)
class Arrays:
    """What a file holds of N robots.

    Attributes:
        poses: (T, 3, N) x, y, theta.
        counts: (T, 2, N) left and right encoder counts; None where the file has none.
        times: (T,) seconds; None where the file has none.
    """

    poses: Real
    counts: Real | None
    times: Real | None

    @property
    def robots(self) -> int:
        return self.poses.shape[2]


def read_arrays(path: Path, robot: int = 1) -> tuple[Real, Real]:
    """Poses (T, 3) and counts (T, 2) of one robot of a log, 1 the first.

    Raises:
        LogError: the file cannot be read, or does not hold these arrays.
    """
    arrays = read_all(path)
    if arrays.counts is None:
        raise LogError(f"no array of encoder counts: expected one named {' or '.join(COUNTS)}")
    if arrays.counts.shape[2] != arrays.robots:
        raise LogError(f"expected counts of {arrays.robots} robots, as poses, got {arrays.counts.shape[2]}")
    if not 1 <= robot <= arrays.robots:
        raise LogError(f"expected a robot from 1 to {arrays.robots}, got {robot}")
    return arrays.poses[:, :, robot - 1], arrays.counts[:, :, robot - 1]


def read_all(path: Path) -> Arrays:
    """Poses, counts and times of all robots of a log.

    Args:
        path: an .npz or a .mat with arrays of poses and of counts; an .npy of columns x, y, theta, left, right; a CSV
            with a header of these names; a folder of .npy arrays.

    Raises:
        LogError: the file cannot be read, or holds no poses.
    """
    try:
        arrays = _arrays(path)
    except LogError:
        raise
    except FileNotFoundError as error:
        raise LogError("no such file") from error
    except Exception as error:  # numpy, zipfile and scipy raise many kinds for damaged files
        raise LogError(f"cannot be read: {error}") from error
    found = _named(arrays, POSES)
    if found is None:
        raise LogError(f"no array of poses: expected one named {' or '.join(POSES)}, got {', '.join(arrays) or 'none'}")
    poses = _columns(*found, 3)
    found = _named(arrays, COUNTS)
    counts = None if found is None else _columns(*found, 2)
    if counts is not None and len(poses) != len(counts):
        raise LogError(f"expected as many poses as counts, got {len(poses)} and {len(counts)}")
    found = _named(arrays, TIMES)
    times = None if found is None else np.asarray(found[1], dtype=np.float64).ravel()
    if times is not None and (len(times) != len(poses) or not (np.diff(times) > 0.0).all()):
        raise LogError(f"expected {len(poses)} times that grow, one for every pose, got {len(times)}")
    return Arrays(poses, counts, times)


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of a file by name; any exception of numpy's or scipy's where it is damaged."""
    if path.is_dir():
        return {file.stem: np.load(file, allow_pickle=False) for file in sorted(path.glob("*.npy"))}
    match path.suffix:
        case ".npz":
            with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
                return {name: data[name] for name in data.files}
        case ".npy":
            table = np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
            if table.ndim != 2 or 5 not in table.shape:
                raise LogError(f"expected the columns {', '.join(_COLUMNS)}, got an array of shape {table.shape}")
            table = table if table.shape[1] == 5 else table.T
            return {"poses": table[:, :3], "counts": table[:, 3:]}
        case ".csv":
            poses, counts = _from_csv(path)
            return {"poses": poses, "counts": counts}
        case ".mat":
            from scipy.io import loadmat

            return {name: value for name, value in loadmat(path).items() if not name.startswith("__")}
    raise LogError(f"expected a folder of .npy arrays or a file {', '.join(SUFFIXES)}")


def _named(arrays: Mapping[str, Any], names: Iterable[str]) -> tuple[str, NDArray[Any]] | None:
    by_name = {name.lower(): (name, array) for name, array in arrays.items()}
    return next(((by_name[name][0], np.asarray(by_name[name][1])) for name in names if name in by_name), None)


def _columns(name: str, array: NDArray[Any], width: int) -> Real:
    """(T, width, N) of an array (T, width), (width, T), (T, width, N), (T, N, width) or (width, N, T)."""
    if array.dtype.kind not in "iuf":
        raise LogError(f"{name}: expected numbers, got {array.dtype}")
    if array.ndim == 2:
        array = array[..., None] if array.shape[1] == width else array.T[..., None]
    if array.ndim == 3:
        array = np.moveaxis(array, int(np.argmax(array.shape)), 0)
        if array.shape[1] != width and array.shape[2] == width:
            array = np.swapaxes(array, 1, 2)
    if array.ndim != 3 or array.shape[1] != width:
        raise LogError(f"{name}: expected {width} values a turn, got the shape {array.shape}")
    return np.asarray(array, dtype=np.float64)


def _from_csv(path: Path) -> tuple[Real, Real]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.reader(file))
    header = [cell.strip().lower() for cell in rows[0]] if rows else []
    for name in _COLUMNS:
        if name not in header:
            raise LogError(f"expected a header with {', '.join(_COLUMNS)}, {name} is missing")
    columns = [header.index(name) for name in _COLUMNS]
    values = np.full((len(rows) - 1, len(columns)), np.nan)
    for number, row in enumerate(rows[1:]):
        for i, (name, column) in enumerate(zip(_COLUMNS, columns, strict=True)):
            cell = row[column].strip() if column < len(row) else ""
            try:
                values[number, i] = float(cell) if cell else np.nan
            except ValueError as error:
                raise LogError(f"line {number + 2}: {name}: expected a number, got {cell!r}") from error
    return values[:, :3], values[:, 3:]
