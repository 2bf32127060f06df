"""A scenario as a script that the Robotarium runs: numpy and rps, nothing of ours. Runs nothing and writes no file."""

__all__ = [
    "calibration",
    "certificate",
    "corner_laws",
    "course",
    "laws",
    "listing",
    "pieces",
    "portable",
    "references",
    "script",
    "wording",
]
