"""The CSV file of a reference's way-points: read when its scenario is, whose points it becomes. Loads no numpy."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from scenarios.definition.files import way_function
from scenarios.definition.files.reading import read_regular
from scenarios.errors import InputError, did_you_mean

COLUMNS = ("t_s", "x_m", "y_m", "scale", "turn_deg")
"""Of a file of way-points; the last two may be left out."""

REQUIRED = COLUMNS[:3]

WAY_POINTS = "way-points"
"""The kind of reference that may come from a file."""


def with_file(data: dict[str, Any], scenario: str, folder: Path) -> dict[str, Any]:
    """A parsed scenario in which the way-points of ``reference.file`` stand in the place of the file's name.

    Args:
        data: parsed TOML, changed in place.
        scenario: as given, for messages.
        folder: of the scenario file, where the name's path starts.

    Raises:
        InputError: the file cannot be read, or is no table of way-points; the message names file, line and column.
    """
    table = data.get("reference")
    if not isinstance(table, dict) or not isinstance(table.get("file"), str):
        return data
    if "points" in table:
        raise InputError(f"{scenario}: reference.file: expected either file or points, got both")
    if table.get("kind", WAY_POINTS) != WAY_POINTS:
        raise InputError(f'{scenario}: reference.file: only for kind = "{WAY_POINTS}", got "{table["kind"]}"')
    path = folder / table["file"]
    if path.suffix == ".py":
        return _with_function(data, table, scenario, path)
    if "function" in table:
        raise InputError(f"{scenario}: reference.function: only with a Python file, NAME.py, got {path.name}")
    try:
        text = read_regular(path).decode("utf-8-sig")
    except (OSError, ValueError) as error:  # also bytes that are no text, and a path with a null byte
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{scenario}: reference.file: {path} cannot be read: {reason}") from None
    del table["file"]
    table["points"] = read_points(text, str(path))
    return data


def _with_function(data: dict[str, Any], table: dict[str, Any], scenario: str, path: Path) -> dict[str, Any]:
    seconds = data.get("duration_s")
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        raise InputError(f"{scenario}: duration_s: missing, a function needs to know until when")
    name = table.pop("function", None)
    del table["file"]
    table["points"] = way_function.read_points(path, name, float(seconds), scenario)
    table.setdefault("ends", "moving")
    return data


def read_points(text: str, path: str) -> list[dict[str, Any]]:
    """The way-points in comma-separated text with a header of :data:`COLUMNS`, as the scenario has them.

    Raises:
        InputError: a column is missing or unknown, or a cell is no number.
    """
    lines = csv.reader(io.StringIO(text))
    header = [name.strip() for name in next(lines, [])]
    for name in header:
        if name not in COLUMNS:
            raise InputError(f"{path}: line 1: unknown column {name!r}, {did_you_mean(name, COLUMNS)}")
        if header.count(name) > 1:
            raise InputError(f"{path}: line 1: column {name} is there {header.count(name)} times")
    for name in REQUIRED:
        if name not in header:
            raise InputError(f"{path}: line 1: column {name} is missing, expected {', '.join(COLUMNS)}")
    points = []
    for cells in lines:
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(header):
            raise InputError(f"{path}: line {lines.line_num}: expected {len(header)} cells, got {len(cells)}")
        row = {}
        for name, cell in zip(header, cells, strict=True):
            try:
                row[name] = float(cell)
            except ValueError:
                raise InputError(
                    f"{path}: line {lines.line_num}: {name}: expected a number, got {cell.strip()[:40]!r}"
                ) from None
        point: dict[str, Any] = {"t_s": row.pop("t_s"), "position_m": [row.pop("x_m"), row.pop("y_m")]}
        points.append(point | row)
    return points
