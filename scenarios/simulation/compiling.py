"""The first run on a machine compiles what periods call, which takes seconds: say so, once, before work spreads."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from scenarios.definition.experiment import Experiment, build
from scenarios.simulation.compiled.ability import unable
from scenarios.simulation.loop import simulate

ANNOUNCEMENT = "formation: compiling, once"
"""What stands on stderr before."""


def compile_for(experiment: Experiment, run: Callable[[], object] | None = None) -> None:
    """Compile what the runs of an experiment need, where no machine code of it is at hand; many need nothing.

    Processes that are started afterwards find the machine code, where there is a folder to keep it in.

    Args:
        experiment: that is to run.
        run: what compiles it, where it is more than a run of one control period.
    """
    kernel = _kernel(experiment)
    if kernel is None:
        return
    from robots.compiled import at_hand

    if at_hand(kernel):
        return
    print(ANNOUNCEMENT, file=sys.stderr, flush=True)
    if run is None:
        simulate(build(experiment.file, experiment.scenario.plant.control_period_s))
    else:
        run()


def _kernel(experiment: Experiment) -> Callable[..., Any] | None:
    """The compiled function that takes the longest to compile of those that a run calls."""
    if unable(experiment) is None:
        from scenarios.simulation.compiled import period

        return period.integrate if experiment.plant == "single_integrator" else period.advance
    if experiment.safety == "decentralised":
        from robots.safety.step import filter_step

        return filter_step
    return None
