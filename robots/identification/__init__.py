"""What a log of a real robot tells of it: its numbers with intervals, how far it is off by them, logs of known robots.

The way of a log: :mod:`reading` and :mod:`check` make it one robot's :class:`log.Log`, :mod:`odometry` and
:mod:`design` a linear model, :mod:`innovations` and :mod:`likelihood` weigh it, :mod:`estimate` gives the numbers.
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
