"""The reference of a scenario: from its table to what the formation is told."""

from __future__ import annotations

import math

import numpy as np

from formation.references.curves import ClosedCurve, curve_length
from formation.references.protocol import Reference
from formation.references.ramps import Ramps
from formation.references.way_points import WayPoints
from scenarios.definition.schema import ReferenceTable
from scenarios.errors import InputError, located


def build_reference(path: str, table: ReferenceTable) -> Reference:
    """What a formation is told, of a table that :func:`~scenarios.definition.load.validate` has passed.

    Raises:
        InputError: keys that do not belong to the kind, are missing, or make no path; the message names the field.
    """
    if table.function is not None:
        raise InputError(f"{path}: reference.function: only with reference.file, a Python file")
    if table.ends == "moving" and table.kind != "way-points":
        raise InputError(f'{path}: reference.ends: only for kind = "way-points", got "{table.kind}"')
    if table.velocities and table.kind != "ramps":
        raise InputError(f'{path}: reference.velocities: only for kind = "ramps", got "{table.kind}"')
    if table.points and table.kind != "way-points":
        raise InputError(f'{path}: reference.points: only for kind = "way-points", got "{table.kind}"')
    if table.kind == "way-points":
        return _way_points(path, table)
    if table.kind == "ramps":
        return _ramps(path, table)
    if table.width_m is None:
        raise InputError(f"{path}: reference.width_m: missing, the {table.kind} needs it")
    if (table.height_m is None) != (table.kind == "circle"):
        round_ = table.kind == "circle"
        what = "a circle has its width alone, expected none" if round_ else f"missing, the {table.kind} needs it"
        raise InputError(f"{path}: reference.height_m: {what}")
    if (table.period_s is None) == (table.speed_m_s is None):
        both = "neither" if table.period_s is None else "both"
        raise InputError(f"{path}: reference.period_s: expected either period_s or speed_m_s, got {both}")
    size = (table.width_m, table.width_m if table.height_m is None else table.height_m)
    period = table.period_s or curve_length(table.kind, size) / (table.speed_m_s or 1.0)
    return ClosedCurve(
        table.kind, size, period, math.radians(table.direction_deg), table.clockwise, table.orientation == "along-path"
    )


def _ramps(path: str, table: ReferenceTable) -> Reference:
    _check_open(path, table, "ramps have times and velocities")
    with located(path, "reference.velocities"):
        return Ramps(
            np.array([each.t_s for each in table.velocities]),
            np.array([complex(*each.velocity_m_s) for each in table.velocities]),
            np.array([each.scale for each in table.velocities]),
            np.radians([each.turn_deg for each in table.velocities]),
        )


def _check_open(path: str, table: ReferenceTable, have: str) -> None:
    """Keys of closed curves are refused elsewhere."""
    for key in ("width_m", "height_m", "period_s", "speed_m_s"):
        if getattr(table, key) is not None:
            raise InputError(f"{path}: reference.{key}: only for closed curves, {have}")


def _way_points(path: str, table: ReferenceTable) -> Reference:
    _check_open(path, table, "way-points have times and places")
    times = np.array([point.t_s for point in table.points])
    places = np.array([complex(*point.position_m) for point in table.points])
    with located(path, "reference.points"):
        return WayPoints(
            times,
            places,
            np.array([point.scale for point in table.points]),
            np.radians([point.turn_deg for point in table.points]),
            table.ends == "moving",
        )
