"""What is compared of a run, and how far it may be off on another machine.

The final angles, their error sums at the ends of phases and of the run, the settling time and the smallest separation
are numbers; the outcome, the testbed's verdict and the safety filter are texts. Names are the keys of ``result.json``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

FLOOR = 1e-9
"""Radians or metres: far above what rounding does to a run that forgets it, far below what anybody cares for."""

PERIODS = 1.5
"""Control periods by which a settling time may differ: a crossing that falls on a sample counts one later or earlier,
and a period is stretched by less than a half to fit its phase."""

MARGIN = 10.0
"""Factor on the measured spread: four copies do not meet the worst case."""


@dataclass(frozen=True)
class Measures:
    """What is compared of one run.

    Attributes:
        numbers: by name; radians, metres or seconds as the name ends in _rad, _m or _s; None for what did not happen.
        texts: by name.
    """

    numbers: dict[str, float | None]
    texts: dict[str, str]


def measures(result: dict[str, Any]) -> Measures:
    """What is compared, from the content of ``result.json``."""
    numbers = {
        f"{angle['name']}.final_rad": None if angle["final_deg"] is None else math.radians(angle["final_deg"])
        for angle in result["angles"]
    }
    for number, phase in enumerate(result["phases"], start=1):
        numbers[f"phases.{number}.angle_error_sum_rad"] = phase["angle_error_sum_rad"]
    for key in ("angle_error_sum_rad", "axle_angle_error_sum_rad", "settling_time_s"):
        numbers[key] = result[key]
    numbers["min_separation.distance_m"] = result["min_separation"]["distance_m"]
    testbed = result["testbed"]
    verdict = ["accepted" if testbed["accepted"] else "rejected", *(v["kind"] for v in testbed["violations"])]
    texts = {"outcome": result["outcome"], "testbed": " ".join(verdict), "safety": str(result["safety"])}
    return Measures(numbers, texts)


def is_angle(name: str) -> bool:
    """Whether a number is one of the final angles."""
    return name.endswith(".final_rad")


def distance(name: str, a: float | None, b: float | None) -> float:
    """How far two values of a number are apart; angles round the circle; infinite where only one of them is None."""
    if a is None or b is None:
        return 0.0 if a is b else math.inf
    return abs(math.remainder(a - b, math.tau)) if is_angle(name) else abs(a - b)


def tolerance(name: str, spread: float, control_period: float) -> float:
    """How far a number may be off on another machine, from its spread over perturbed copies of the run."""
    floor = PERIODS * control_period if name.endswith("_s") else FLOOR
    return floor + MARGIN * spread
