"""What a reference asks for, in plain words: its speeds, how the formation turns, how far the shape will lag."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from formation import agents
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.course import course

EXACT = 1e-9
"""Shape residual below which following is called exact."""


def print_course(console: Console, experiment: Experiment, start: NDArray[np.float64]) -> None:
    """Nothing where phases are constant, or the law has no theory."""
    found, reference = course(experiment, start), experiment.phases[0].reference
    if found is None or reference is None:
        return
    console.print("\n[bold]Reference[/bold]")
    leader, fastest = found.speed[agents.LEADER], int(found.speed.argmax())
    round_ = "" if reference.cycle is None else f", one round in {reference.cycle:g} s"
    console.print(
        f"- {experiment.phases[0].name}{round_}: the leader at up to {leader:.3f} m/s, "
        f"{agents.name(fastest)} fastest at {found.speed[fastest]:.3f} m/s"
    )
    scaling = f", scales at up to {found.scaling:.3f} 1/s" if found.scaling > 0.0 else ""
    console.print(f"- the formation turns at up to {found.turning:.3f} rad/s{scaling}")
    console.print(f"- {_lag(experiment, found.lag)}")


def _lag(experiment: Experiment, lag: tuple[float, float] | None) -> str:
    told = "with feed-forward" if experiment.scenario.law.feedforward else "without feed-forward"
    if lag is None:
        return f"shape {told}: no closed form covers this law, sensing or reference"
    if lag[0] < EXACT:
        return f"shape {told}: exact once settled"
    repeats = experiment.phases[0].reference is not None and experiment.phases[0].reference.cycle is not None
    when = "once settled" if repeats else "from its places on, by the law alone"
    return f"shape {told}, {when}: residual at most {100.0 * lag[0]:.3g} %, {100.0 * lag[1]:.3g} % rms"
