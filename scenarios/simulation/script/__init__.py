"""A script for the Robotarium while it runs: its clock, its figures, and how it ends; not what is made of that."""

__all__ = ["clock", "execute", "frames", "hints", "offscreen", "screen", "script_file"]
