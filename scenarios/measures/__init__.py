"""From a trajectory to what it achieved: metrics, tracking, misfits, ``result.json``. Draws and writes nothing."""

__all__ = [
    "clearance",
    "closed_forms",
    "contacts",
    "happenings",
    "late_rates",
    "metrics",
    "online",
    "predictions",
    "result",
    "safety_result",
    "script_result",
    "series",
    "tracking",
    "window",
]
