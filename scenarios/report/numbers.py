"""The numbers of finished runs as a sheet: one run, or two beside each other with their differences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scenarios.documents import Sheet, Value

Quantity = tuple[str, str]
"""Name and unit."""


def side_by_side(names: Sequence[str], results: Sequence[dict[str, Any]]) -> Sheet:
    """A row per quantity: name, unit, the value of each run, and of two runs the second less the first.

    Args:
        names: of the runs, above their columns.
        results: the content of each ``result.json``.
    """
    told = [_quantities(result) for result in results]
    rows: list[list[Value]] = []
    for name, unit in dict.fromkeys(key for quantities in told for key in quantities):
        values = [quantities.get((name, unit)) for quantities in told]
        rows.append([name, unit, *values, *([_difference(*values)] if len(values) == 2 else [])])
    return Sheet(["quantity", "unit", *names, *(["difference"] if len(told) == 2 else [])], rows)


def _quantities(result: dict[str, Any]) -> dict[Quantity, float | None]:
    """What a result says in numbers."""
    found: dict[Quantity, float | None] = {}
    for angle in result["angles"]:
        found[f"{angle['name']} target", "deg"] = angle["target_deg"]
        found[f"{angle['name']} error", "rad"] = angle["error_rad"]
        found[f"{angle['name']} axle error", "rad"] = angle["axle_error_rad"]
    found["angle error sum", "rad"] = result["angle_error_sum_rad"]
    found["axle angle error sum", "rad"] = result["axle_angle_error_sum_rad"]
    if "mean_angle_error_sum_rad" in result:
        found["mean angle error sum", "rad"] = result["mean_angle_error_sum_rad"]
        found["rms angle error sum", "rad"] = result["rms_angle_error_sum_rad"]
    found["settling time", "s"] = result["settling_time_s"]
    found["smallest separation", "m"] = result["min_separation"]["distance_m"]
    found["duration", "s"] = result["duration_s"]
    found["converged", "0 or 1"] = int(result["outcome"] == "converged")
    found["accepted by the testbed", "0 or 1"] = int(result["testbed"]["accepted"])
    return found


def _difference(first: float | None, second: float | None) -> float | None:
    return None if first is None or second is None else second - first
