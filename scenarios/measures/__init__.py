"""From a trajectory to what it achieved: metrics, tracking, misfits, ``result.json``. Draws and writes nothing."""

__all__ = [
    "contacts",
    "forecast",
    "late_rates",
    "metrics",
    "misfits",
    "remarks",
    "result",
    "safety_result",
    "script_result",
    "theory",
    "tracking",
    "window",
]
