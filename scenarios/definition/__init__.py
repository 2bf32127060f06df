"""From a scenario file to an :class:`~scenarios.definition.experiment.Experiment`: schema, targets, starts, own laws.

Nothing here moves a robot.
"""

__all__ = [
    "bounds",
    "choice",
    "digest",
    "events",
    "experiment",
    "files",
    "formations",
    "keys",
    "load",
    "own_law",
    "parts",
    "references",
    "schema",
    "starts",
    "targets",
]
