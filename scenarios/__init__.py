"""The experiments: from a scenario file to a trajectory, to what it achieved, to pictures, and to studies of many runs.

Knows theory and machines, which do not know it; holds no law and no physics of its own. Rooms are floors of one tower,
each importing what lies below it alone: CONTRIBUTING.md shows it. What most people need is offered here, ``run`` and
``sweep`` for whole runs that show themselves, and what they are made of:

>>> from scenarios import measure, open_experiment, simulate
>>> experiment = open_experiment("shape", ("plant.name=saturated", "safety.filter=none"), duration=1.0)
>>> measure(experiment, simulate(experiment, seed=0)).outcome
'not_converged'
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scenarios.definition.experiment import open_experiment as open_experiment
    from scenarios.interactive.many import sweep as sweep
    from scenarios.interactive.single import run as run
    from scenarios.measures.metrics import measure as measure
    from scenarios.simulation.loop import simulate as simulate

    __version__: str

__all__ = ["__version__", "measure", "open_experiment", "run", "simulate", "sweep"]

_HOMES = {
    "measure": "scenarios.measures.metrics",
    "open_experiment": "scenarios.definition.experiment",
    "run": "scenarios.interactive.single",
    "simulate": "scenarios.simulation.loop",
    "sweep": "scenarios.interactive.many",
}

if not TYPE_CHECKING:  # type checkers would take any name for one that is there

    def __getattr__(name: str) -> Any:
        """What is offered, loaded when it is asked for: ``import scenarios`` loads no numpy."""
        if name == "__version__":
            from importlib.metadata import version

            return version("angle-formation")
        if name in _HOMES:
            from importlib import import_module

            return getattr(import_module(_HOMES[name]), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
