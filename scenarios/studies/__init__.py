"""Many runs: sweeps, the comparison with baselines, laws side by side, audits, the paper's numbers.

A study opens, runs, measures and prints; how one run is made or measured is not decided here.
"""

__all__ = [
    "adoption",
    "audit",
    "check",
    "design",
    "exported",
    "identification",
    "ladder",
    "league",
    "project",
    "reproduction",
    "shares",
    "sweep",
    "testbed",
]
