"""Runs and sweeps as Python and notebooks expect them: values that show, draw and save themselves.

What makes them are the functions behind ``formation run`` and ``formation sweep``: this room has no way of its own, and
nothing here parses or exits.
"""

__all__ = ["film", "frames", "many", "single", "viewer"]
