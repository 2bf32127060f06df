"""From an experiment to a trajectory: the loop, its controller, its guard. Knows no measure of the result."""

__all__ = [
    "compiled",
    "compiling",
    "controller",
    "guard",
    "loop",
    "outages",
    "schedule",
    "script",
    "told",
    "trajectory",
]
