"""A real robot's numbers from a log: wheels, base, tracked point, lags, noise, slip, each with a 95 % interval.

Knows no scenario and draws nothing.
"""

__all__ = [
    "check",
    "design",
    "estimate",
    "innovations",
    "likelihood",
    "log",
    "numbers",
    "odometry",
    "reading",
    "reckoning",
    "synthetic",
]
