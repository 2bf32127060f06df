"""``result.json`` of a script's run. Robots are counted from 0, as scripts count them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from robots.rps.robotarium import Robotarium
from robots.rps.simulation import Record
from robots.testbed import Occurrence, Verdict, Violation, collision_centres, judge, separation
from robots.worlds import NOTHING
from scenarios.measures.result import versions
from scenarios.simulation.script.execute import Ending
from scenarios.simulation.script.script_file import ScriptFile
from scenarios.storage.script_folder import KIND

SCHEMA_VERSION = 1


OUTCOMES = {
    "ended": "came to its end",
    "exited": "ended itself by exit()",
    "raised": "raised an error",
    "interrupted": "was interrupted",
    "stopped": "was stopped at the end of --duration",
}
"""How a script ended, in words."""


def chosen(robots: Sequence[Robotarium]) -> Robotarium | None:
    """Whose run is kept, of several sets of robots: the one that drove longest, the last of equals."""
    return max(reversed(robots), key=lambda each: each.steps, default=None)


def script_result(
    file: ScriptFile, arguments: Sequence[str], seed: int, start: str, plant: str, ending: Ending, robots: Robotarium
) -> dict[str, Any]:
    """The content of ``result.json``."""
    record = robots.record()
    verdict = judge(record.t, record.poses, record.wheel_speeds, drive=robots.robot.drive)
    return {
        "schema_version": SCHEMA_VERSION,
        "kind": KIND,
        "script": file.name,
        "script_sha256": file.sha256,
        "arguments": list(arguments),
        "rps": file.version,
        "seed": seed,
        "plant": plant,
        "start": start,
        "versions": versions(),
        "robots": robots.number_of_robots,
        "sets_of_robots": len(ending.robots),
        "steps": robots.steps,
        "duration_s": float(record.t[-1]),
        "outcome": ending.outcome,
        "exit_code": ending.code,
        "error": ending.text or None,
        "advice": ending.advice,
        "way_m": np.linalg.norm(np.diff(record.poses[..., :2], axis=0), axis=-1).sum(axis=0).tolist(),
        "min_separation": _closest(record),
        "contacts": _contacts(record),
        "testbed": _testbed(verdict),
    }


def describe(violation: dict[str, Any]) -> str:
    """One kind of violation, in a line: the worst of it, and when it began."""
    first, worst = violation["first"], violation["worst"]
    who, began = (" and ".join(str(robot) for robot in each["robots"]) for each in (worst, first))
    x, y = worst["place_m"]
    by = "" if who == began else f" by {began}"
    where = (
        f"worst at {worst['time_s']:.2f} s, ({x:.4g}, {y:.4g}) m, first at {first['time_s']:.2f} s{by}, "
        f"{violation['steps']} steps"
    )
    match violation["kind"]:
        case "floor":
            return f"robot {who} leaves the floor by {worst['value']:.3f} m; {where}"
        case "collision":
            return f"robots {who} come within {worst['value']:.3f} m; {where}"
        case _:
            return f"robot {who} commands a wheel to {worst['value']:.6g} rad/s (warning); {where}"


def _closest(record: Record) -> dict[str, Any]:
    near = separation(collision_centres(record.poses))
    row = int(near.distance.argmin())
    distance = float(near.distance[row])
    if not np.isfinite(distance):
        return {"distance_m": None, "time_s": None, "robots": None}
    return {"distance_m": distance, "time_s": float(record.t[row]), "robots": near.pairs[row].tolist()}


def _contacts(record: Record) -> dict[str, Any]:
    """In how many control periods any robot touched another one, who, and who first."""
    touches = record.contacts != NOTHING
    periods = np.flatnonzero(touches.any(axis=1))
    if not periods.size:
        return {"periods": 0, "robots": [], "first": None}
    first = periods[0]
    return {
        "periods": len(periods),
        "robots": np.flatnonzero(touches.any(axis=0)).tolist(),
        "first": {"time_s": float(record.t[first]), "robots": np.flatnonzero(touches[first]).tolist()},
    }


def _testbed(verdict: Verdict) -> dict[str, Any]:
    return {"accepted": verdict.accepted, "violations": [_violation(each) for each in verdict.violations]}


def _violation(violation: Violation) -> dict[str, Any]:
    return {
        "kind": violation.kind,
        "steps": violation.steps,
        "first": _occurrence(violation.first),
        "worst": _occurrence(violation.worst),
    }


def _occurrence(occurrence: Occurrence) -> dict[str, Any]:
    return {
        "time_s": occurrence.time,
        "robots": list(occurrence.robots),
        "place_m": list(occurrence.place),
        "value": occurrence.value,
    }
