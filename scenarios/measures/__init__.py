"""From a trajectory to what it achieved: metrics, tracking, misfits, ``result.json``. Draws and writes nothing."""

__all__ = ["forecast", "metrics", "misfits", "remarks", "result", "safety_result", "tracking", "window"]
