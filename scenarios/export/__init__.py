"""A scenario as a script that the Robotarium runs: numpy and rps, nothing of ours. Runs nothing and writes no file."""

__all__ = ["calibration", "pieces", "portable", "script"]
