"""From a scenario file to an :class:`~scenarios.definition.experiment.Experiment`: schema, targets, starts, own laws.

Nothing here moves a robot.
"""

__all__ = [
    "bounds",
    "digest",
    "experiment",
    "formations",
    "keys",
    "law_file",
    "load",
    "own_law",
    "reading",
    "schema",
    "starts",
    "targets",
]
