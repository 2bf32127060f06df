"""The testbed's verdict in a script's own words: robots count from 0."""

from __future__ import annotations

from robots.testbed import COLLISION_DISTANCE, Violation


def sentence(violation: Violation) -> str:
    """One line on a violation: the worst of it, and when it began."""
    first, worst = violation.first, violation.worst
    who = " and ".join(str(robot) for robot in worst.robots)
    what = {
        "floor": f"robot {who} leaves the floor by {worst.value:.3f} m",
        "collision": f"robots {who} come within {COLLISION_DISTANCE} m: {worst.value:.3f} m",
        "obstacle": f"robot {who} comes within {worst.value:.3f} m of an obstacle",
        "actuator": f"robot {who} is commanded {worst.value:.10g} rad/s at a wheel, which is clipped",
    }[violation.kind]
    severity = "WARNING" if violation.kind == "actuator" else "ERROR"
    x, y = worst.place
    other = "" if first.robots == worst.robots else f" by robot {' and '.join(map(str, first.robots))}"
    return (
        f"{severity}: {what}; worst at {worst.time:.2f} s near ({x:.2f}, {y:.2f}) m, "
        f"first at {first.time:.2f} s{other}, {violation.steps} steps"
    )
