"""What can be said of a run before anything moves: where theory sends it, how it behaves, what speaks against it.

Measures no trajectory.
"""

__all__ = ["course", "filtered", "forecast", "misfits", "remarks", "stops", "theory", "way"]
