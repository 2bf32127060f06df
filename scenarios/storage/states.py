"""``trajectory.npz`` read back: shapes and types from its headers first, so that nothing is loaded that cannot fit."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots.safety.protocol import BLOCKERS, WALLS
from robots.worlds import NOTHING
from scenarios.definition.experiment import Experiment
from scenarios.definition.files.reading import open_regular
from scenarios.errors import InputError
from scenarios.simulation.schedule import count_periods
from scenarios.simulation.trajectory import Trajectory

REAL, INDEX, SMALL, FLAG = (np.dtype(kind) for kind in (np.float64, np.intp, np.int32, np.bool_))

SAME_PLACE = 1e-9
"""Metres between a start and the first state, which is computed from it."""

NOT_NEGATIVE = ("intervention", "relaxation", "stuck")

YOUNGER = ("wish", "command")
"""Fields that older run folders do not have; not known is NaN."""


def read(path: Path, experiment: Experiment, seed: int) -> Trajectory:
    """The states of the run of that experiment with that seed.

    Raises:
        InputError: the file is missing or damaged, or a field has another shape, type or range than a run's.
    """
    with _opened(path) as archive:
        rows = _rows(path, archive, experiment)
        states = {}
        for name, (dtype, shape) in _layout(experiment, rows).items():
            if name in YOUNGER and not _has(archive, name):
                states[name] = np.full(shape, np.nan)
                continue
            found_dtype, found_shape = _header(path, archive, name)
            if found_shape != shape:
                raise InputError(f"{path}: {name}: expected the shape {shape}, got {found_shape}")
            if found_dtype != dtype:
                raise InputError(f"{path}: {name}: expected {dtype}, got {found_dtype!s:.40}")
            states[name] = _array(path, archive, name)
    trajectory = Trajectory(**{field.name: states[field.name] for field in fields(Trajectory)})
    _check_values(path, experiment, trajectory)
    if not np.allclose(trajectory.points[0], experiment.initial_points(seed), rtol=1e-12, atol=SAME_PLACE):
        raise InputError(f"{path}: points: expected to begin where the scenario and seed {seed} say")
    return trajectory


def _layout(experiment: Experiment, rows: int) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    """Type and shape of every field."""
    n = experiment.n
    return {
        "t": (REAL, (rows,)),
        "poses": (REAL, (rows, n, 3)),
        "points": (REAL, (rows, n, 2)),
        "wheel_speeds": (REAL, (rows, n, 2)),
        "phase": (INDEX, (rows,)),
        "contact": (INDEX, (rows, n)),
        "active": (FLAG, (rows, n)),
        "intervention": (REAL, (rows, n)),
        "relaxation": (REAL, (rows, n)),
        "blockers": (SMALL, (rows, n, BLOCKERS)),
        "stuck": (REAL, (rows, n)),
        "wish": (REAL, (rows, n, 2)),
        "command": (REAL, (rows, n, 2)),
        "angle_errors": (REAL, (rows, len(experiment.angles))),
    }


def _check_values(path: Path, experiment: Experiment, trajectory: Trajectory) -> None:
    """Ranges; a run that diverged ends with a row that is not finite."""
    n, t = experiment.n, trajectory.t
    if not (np.isfinite(t).all() and t[0] == 0.0 and (np.diff(t) > 0.0).all()):
        raise InputError(f"{path}: t: expected times that begin at 0 and grow from row to row")
    for name in ("poses", "points"):
        if not np.isfinite(getattr(trajectory, name)[:-1]).all():
            raise InputError(f"{path}: {name}: expected finite numbers in all rows but the last")
    if not np.isfinite(trajectory.poses[0]).all():
        raise InputError(f"{path}: poses: expected a finite start")
    things = n + WALLS + len(experiment.arena.obstacles)
    for name, low, end in (
        ("phase", 0, len(experiment.phases)),
        ("contact", NOTHING, n + 1),
        ("blockers", -1, things),
    ):
        values = getattr(trajectory, name)
        if not ((values >= low) & (values < end)).all():
            raise InputError(f"{path}: {name}: expected integers from {low} to {end - 1}")
    if (np.diff(trajectory.phase) < 0).any():
        raise InputError(f"{path}: phase: expected phases in their order")
    for name in NOT_NEGATIVE:
        if (getattr(trajectory, name) < 0.0).any():
            raise InputError(f"{path}: {name}: expected no negative number")


@contextmanager
def _opened(path: Path) -> Iterator[zipfile.ZipFile]:
    with _told(path, ""):
        file = open_regular(path)
    with file:
        with _told(path, ""):
            archive = zipfile.ZipFile(file)
        with archive:
            yield archive


def _rows(path: Path, archive: zipfile.ZipFile, experiment: Experiment) -> int:
    """How many states there are: all of the run, or fewer where it diverged."""
    most = 1 + count_periods(experiment)
    _, shape = _header(path, archive, "t")
    if len(shape) != 1 or not 2 <= shape[0] <= most:
        raise InputError(f"{path}: t: expected the shape (T,) with T from 2 to {most}, got {shape}")
    return shape[0]


def _header(path: Path, archive: zipfile.ZipFile, name: str) -> tuple[np.dtype[Any], tuple[int, ...]]:
    """Type and shape of a field, from its header alone."""
    if not _has(archive, name):
        raise InputError(f"{path}: {name}: missing")
    with _told(path, name), archive.open(f"{name}.npy") as member:
        version = np.lib.format.read_magic(member)
        read_header: Callable[[Any], tuple[tuple[int, ...], bool, np.dtype[Any]]] = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, _, dtype = read_header(member)
    return dtype, shape


def _has(archive: zipfile.ZipFile, name: str) -> bool:
    return f"{name}.npy" in archive.namelist()


def _array(path: Path, archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    with _told(path, name), archive.open(f"{name}.npy") as member:
        return np.ascontiguousarray(np.lib.format.read_array(member, allow_pickle=False))


@contextmanager
def _told(path: Path, name: str) -> Iterator[None]:
    """One line for whatever numpy and zipfile raise for damaged files, which are many kinds."""
    try:
        yield
    except Exception as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        field = f"{name}: " if name else ""
        raise InputError(f"{path}: {field}cannot be read: {reason or type(error).__name__}") from error
