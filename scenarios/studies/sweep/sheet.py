"""A finished sweep as a sheet: a row per combination of the varied values."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.documents import Sheet, Value
from scenarios.errors import InputError
from scenarios.studies.sweep.folder import ROWS, read_cells
from scenarios.studies.sweep.row import RUN_COLUMNS, Row, columns
from scenarios.studies.sweep.summary import QUANTILES, QUANTITIES, Share, summarise

SHOWN = (0.05, 0.5, 0.95)
"""Quantiles that have a column."""


def is_sweep(folder: Path) -> bool:
    """Whether ``folder`` holds a finished sweep."""
    return (folder / ROWS).is_file()


def sheet(folder: Path) -> Sheet:
    """The varied values, the number of runs, shares with 95 % intervals, and quantiles of what was measured.

    Raises:
        InputError: ``rows.csv`` is not a sweep's.
    """
    with _told(folder):
        return _sheet(read_cells(folder))


@dataclass(frozen=True)
class Groups:
    """The runs of a sweep by combination, for a figure.

    Attributes:
        key: what is varied, keys joined by commas; empty where nothing is.
        labels: the varied values of each combination.
        shares: (combinations, 3) share that converged, with its 95 % interval.
        values: by column, for each combination what its runs have.
    """

    key: str
    labels: list[str]
    shares: NDArray[np.float64]
    values: dict[str, list[NDArray[np.float64]]]


def groups(folder: Path) -> Groups:
    """The runs of a finished sweep by combination.

    Raises:
        InputError: ``rows.csv`` is not a sweep's.
    """
    labels: list[str] = []
    varied: list[str] = []
    shares: list[tuple[float, float, float]] = []
    values: dict[str, list[NDArray[np.float64]]] = {column: [] for column in QUANTITIES}
    with _told(folder):
        for combination, group in groupby(read_cells(folder), key=lambda row: tuple(_combination(row).items())):
            known = {name: value for name, value in combination if name not in ("scenario", "plant")}
            varied = list(known)
            labels.append(", ".join(known.values()))
            numbers, runs, converged = {column: array("d") for column in QUANTITIES}, 0, 0
            for cells in group:
                runs += 1
                converged += cells["outcome"] == "converged"
                for column, found in numbers.items():
                    if cells[column]:
                        found.append(float(cells[column]))
            share = Share.of(converged, runs)
            shares.append((share.share, share.low, share.high))
            for column, found in numbers.items():
                values[column].append(np.array(found))
        if not labels:
            raise ValueError("no rows")
    return Groups(", ".join(varied), labels, np.array(shares), values)


@contextmanager
def _told(folder: Path) -> Iterator[None]:
    """One line for what csv and float make of a damaged file."""
    try:
        yield
    except (ValueError, KeyError, TypeError, IndexError) as error:
        raise InputError(f"{folder / ROWS}: not the rows of a sweep, damaged or edited") from error


def _sheet(rows: Iterator[Mapping[str, str]]) -> Sheet:
    lines: list[list[Value]] = []
    known: dict[str, str] = {}
    for combination, group in groupby(rows, key=lambda row: tuple(_combination(row).items())):
        known = dict(combination)
        told = summarise(map(Row.read, group))
        line: list[Value] = [*known.values(), told.runs]
        for share in (told.converged, told.accepted):
            line += [share.share, share.low, share.high]
        for column in QUANTITIES:
            values = told.quantiles[column]
            line += [None if values is None else values[QUANTILES.index(level)] for level in SHOWN]
        lines.append(line)
    if not lines:
        raise ValueError("no rows")
    shares = [f"{name}{end}" for name in ("converged", "accepted") for end in ("", ".low", ".high")]
    quantiles = [f"{column}.q{level * 100:02.0f}" for column in QUANTITIES for level in SHOWN]
    return Sheet([*known, "runs", *shares, *quantiles], lines)


def _combination(row: Mapping[str, str]) -> dict[str, str]:
    """What all runs of one combination share: all that tells a run but its seed; the plant once, where it is varied."""
    names = list(row)[: len(row) - len(columns([])) + RUN_COLUMNS]
    without = {"seed", "plant" if "plant.name" in names else "seed"}
    return {name: row[name] for name in names if name not in without}
