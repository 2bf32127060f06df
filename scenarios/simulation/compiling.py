"""The first run on a machine compiles the safety filter, which takes seconds: say so, once, before the work spreads."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable

import numpy as np

from robots import GTERNAL, NearIdentityDiffeomorphism
from robots.model import COLLISION_CENTRE, CONTROL_PERIOD
from robots.safety import FilterSettings, make_filter
from scenarios.definition.schema import Scenario

ANNOUNCEMENT = "formation: compiling, once"
"""What stands on stderr before."""


def compile_filter(name: str = "decentralised") -> None:
    """Compile the filter ``name`` where no machine code of it is at hand; others have nothing to compile.

    Processes that are started afterwards find the machine code, where there is a folder to keep it in.
    """
    if name != "decentralised":
        return
    from robots.compiled import at_hand  # numba is loaded only where it is used
    from robots.safety import kernel

    if at_hand(kernel.step):
        return
    print(ANNOUNCEMENT, file=sys.stderr, flush=True)
    still = np.zeros((1, 2))
    ahead = np.array([[1.0, 0.0]])
    nid = NearIdentityDiffeomorphism(COLLISION_CENTRE)
    safety = make_filter(name, (1,), GTERNAL.drive, nid, FilterSettings())
    if safety is not None:
        safety.filter(still, ahead, still, still, CONTROL_PERIOD)


def compile_whole(plant: str, run: Callable[[], object]) -> None:
    """Compile the whole period of a plant, and what looks at it, by a ``run``, where no machine code is at hand."""
    from robots.compiled import at_hand
    from scenarios.simulation.compiled import period

    if not at_hand(period.integrate if plant == "single_integrator" else period.advance):
        print(ANNOUNCEMENT, file=sys.stderr, flush=True)
        run()


def compile_filters(scenarios: Iterable[Scenario]) -> None:
    """:func:`compile_filter` for all of them; the single integrator has points, which no filter keeps apart."""
    for scenario in scenarios:
        if scenario.plant.name != "single_integrator":
            compile_filter(scenario.safety.filter)
