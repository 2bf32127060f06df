"""From a trajectory to what it achieved: metrics, tracking, misfits, ``result.json``. Draws and writes nothing."""

__all__ = ["forecast", "metrics", "misfits", "result", "safety_result", "tracking"]
