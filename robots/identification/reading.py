"""Reading a log from a file, as people keep them: numpy's archives and folders of arrays, CSV, MATLAB's .mat."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
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

_COLUMNS = ("x", "y", "theta", "left", "right")
SUFFIXES = (".npz", ".npy", ".csv", ".mat")


def read_arrays(path: Path, robot: int = 1) -> tuple[Real, Real]:
    """Poses (T, 3) and counts (T, 2) of one robot of a log.

    Args:
        path: an .npz or a .mat with an array of poses and one of counts; an .npy of columns x, y, theta, left, right; a
            CSV with a header of these names; a folder of .npy arrays.
        robot: which, 1 the first, where the log has several.

    Raises:
        LogError: the file cannot be read, or does not hold these arrays.
    """
    try:
        if path.is_dir():
            arrays = {file.stem: np.load(file, allow_pickle=False) for file in sorted(path.glob("*.npy"))}
        elif path.suffix == ".npz":
            with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
                arrays = {name: data[name] for name in data.files}
        elif path.suffix == ".npy":
            arrays = {"": np.load(path, allow_pickle=False)}
        elif path.suffix == ".csv":
            return _from_csv(path)
        elif path.suffix == ".mat":
            arrays = _from_mat(path)
        else:
            raise LogError(f"expected a folder of .npy arrays or a file {', '.join(SUFFIXES)}")
    except LogError:
        raise
    except FileNotFoundError as error:
        raise LogError("no such file") from error
    except Exception as error:  # numpy, zipfile and scipy raise many kinds for damaged files
        raise LogError(f"cannot be read: {error}") from error
    if list(arrays) == [""]:
        table = np.asarray(arrays[""], dtype=float)
        if table.ndim != 2 or 5 not in table.shape:
            raise LogError(f"expected the columns {', '.join(_COLUMNS)}, got an array of shape {table.shape}")
        table = table if table.shape[1] == 5 else table.T
        return table[:, :3], table[:, 3:]
    poses = _of_robot(*_named(arrays, POSES, "poses"), 3, robot)
    counts = _of_robot(*_named(arrays, COUNTS, "encoder counts"), 2, robot)
    if len(poses) != len(counts):
        raise LogError(f"expected as many poses as counts, got {len(poses)} and {len(counts)}")
    return poses, counts


def _named(arrays: Mapping[str, Any], names: Iterable[str], what: str) -> tuple[str, NDArray[Any]]:
    by_name = {name.lower(): (name, array) for name, array in arrays.items()}
    for name in names:
        if name in by_name:
            return by_name[name][0], np.asarray(by_name[name][1])
    raise LogError(f"no array of {what}: expected one named {' or '.join(names)}, got {', '.join(arrays) or 'none'}")


def _of_robot(name: str, array: NDArray[Any], width: int, robot: int) -> Real:
    """(T, width) of an array (T, width), (width, T), (T, width, N), (T, N, width) or (width, N, T)."""
    if array.dtype.kind not in "iuf":
        raise LogError(f"{name}: expected numbers, got {array.dtype}")
    if array.ndim == 2:
        array = array[..., None] if array.shape[1] == width else array.T[..., None]
    if array.ndim == 3:
        turns = int(np.argmax(array.shape))
        array = np.moveaxis(array, turns, 0)
        if array.shape[1] != width and array.shape[2] == width:
            array = np.swapaxes(array, 1, 2)
    if array.ndim != 3 or array.shape[1] != width:
        raise LogError(f"{name}: expected {width} values a turn, got the shape {array.shape}")
    if not 1 <= robot <= array.shape[2]:
        raise LogError(f"{name}: expected a robot from 1 to {array.shape[2]}, got {robot}")
    return np.asarray(array[:, :, robot - 1], dtype=np.float64)


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


def _from_mat(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    content = loadmat(path, squeeze_me=False)
    return {name: value for name, value in content.items() if not name.startswith("__")}
