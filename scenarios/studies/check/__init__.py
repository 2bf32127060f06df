"""Runs compared with baselines: files that say what each run gave, on which machine, and how far another may differ.

What is measured of a run is not decided here: :mod:`scenarios.measures` does that.
"""

__all__ = [
    "baseline",
    "command",
    "compare",
    "execute",
    "machine",
    "perturbed",
    "quantities",
    "repeat",
    "reports",
    "rows",
    "tables",
    "update",
]
