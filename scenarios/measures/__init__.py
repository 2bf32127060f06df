"""From a trajectory to what it achieved: metrics, tracking, misfits, ``result.json``. Draws and prints nothing."""
