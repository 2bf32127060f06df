"""The closed forms of a scenario, in plain words: what noise, delay and a long cascade will do to it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from formation import agents
from scenarios.definition.experiment import Experiment
from scenarios.measures.closed_forms import AMPLIFIES, CENTIMETRE, ClosedForms, Passages, closed_forms, passages
from scenarios.terminal import new_table, print_table

Real = NDArray[np.float64]

MOST_LISTED = 100
"""Agents that have lines of their own."""

MOST_SOLVED = 1000
"""Agents whose noise is told: its covariance has the square of their number of entries, and takes as long."""

MOST_CROSSINGS = 4
"""Lines of sight that are named."""


def print_closed_forms(console: Console, experiment: Experiment, start: Real) -> None:
    """Per agent and for the formation; nothing for a law that the closed forms are not of."""
    if experiment.n > MOST_SOLVED:
        console.print(f"\nclosed forms of noise, delay and passages: told of up to {MOST_SOLVED} agents")
        return
    found = closed_forms(experiment, start)
    if found is None:
        return
    near = passages(experiment, start)
    console.print("\n[bold]Predicted in closed form[/bold]")
    _print_agents(console, experiment, found, near)
    for sentence in (*_sentences(experiment, found), *(_passages(experiment, near) if near is not None else ())):
        console.print(f"- {sentence}")


def _print_agents(console: Console, experiment: Experiment, found: ClosedForms, near: Passages | None) -> None:
    columns = ["agent", "noise (mm)", "bias gain"]
    if near is not None:
        columns += ["clear of neighbours (m)", "of others (m)", "nearest"]
    table = new_table(*columns)
    for row in range(min(experiment.n, MOST_LISTED)):
        cells = [str(experiment.number(row)), f"{1e3 * found.noise[row]:.2f}", f"{found.bias[row]:.2f}"]
        follower = row - agents.FIRST_ORDINARY
        if near is not None:
            cells += ["-"] * 3 if follower < 0 else _ways(experiment, near, follower)
        table.add_row(*cells)
    print_table(console, table)
    if experiment.n > MOST_LISTED:
        console.print(f"and {experiment.n - MOST_LISTED} agents more")


def _ways(experiment: Experiment, near: Passages, follower: int) -> list[str]:
    other = int(near.nearest[follower])
    who = "-" if other < 0 else str(experiment.number(other))
    return [f"{near.neighbours[follower]:.3f}", f"{near.others[follower]:.3f}", who]


def _sentences(experiment: Experiment, found: ClosedForms) -> list[str]:
    told = [f"{_noise(experiment, found)}; bias gain: offset over independent constant errors of all measurements."]
    if experiment.own_gains is not None:
        told.append(
            f"Own gains from {experiment.own_gains.min():.3g} to {experiment.own_gains.max():.3g}: the slowest "
            f"follower at {found.loop.rates[1:].min():.3g} 1/s; the noisiest has {1e3 * found.noise.max():.2f} mm, "
            f"with gains of 1 {1e3 * found.paper_noise.max():.2f} mm."
        )
    if found.last_over_first > AMPLIFIES:
        told.append(
            f"A long cascade amplifies: depth {experiment.target.graph.depth.max()}, the noisiest follower has "
            f"{found.last_over_first:.1f} times the noise of the first. `formation design` finds a shallower graph."
        )
    if found.growth is not None and found.gains is not None:
        size, when = found.growth
        grow = f"grow up to {size:.2f}-fold, after {when:.1f} s, before they decay" if when else "decay from the start"
        told.append(
            f"All errors together {grow}; largest gain over all frequencies {found.gains[0]:.2f} m/m of measurement "
            f"errors, {found.gains[1]:.2f} s of velocity disturbances."
        )
    told.append(
        f"Held commands are stable up to a control period of {found.longest_period:.3g} s; here {found.period:g} s."
    )
    told.append(_delay(experiment, found))
    told += _turning(experiment, found)
    if found.filter is not None:
        f = found.filter
        told.append(
            f"The delay asks the filter for safety.safe_distance_m={f.safe_distance:.3f}, "
            f"safety.sensing_range_m={f.sensing_range:.3f}, safety.gain_per_s={f.gain:.3f}."
        )
    if found.dwell is not None:
        told.append(
            f"Switching delta by 90 degrees and back every {found.dwell[1]:g} s, the shortest phase, leaves errors of "
            f"up to {found.dwell[0]:.2g} m."
        )
    return told


def _noise(experiment: Experiment, found: ClosedForms) -> str:
    table = experiment.scenario.sensor
    if found.assumed:
        return f"Noise: rms error for {1e2 * CENTIMETRE:g} cm in each measured coordinate, new each period"
    return (
        f"Noise: rms error for the scenario's {1e2 * table.position_noise_m:g} cm and {table.bearing_noise_deg:g} "
        "degrees, new each period"
    )


def _delay(experiment: Experiment, found: ClosedForms) -> str:
    periods = found.most_periods
    law = "any delay" if periods is None else f"{periods} control periods ({periods * found.period:.2f} s) of delay"
    knows = experiment.scenario.sensor.own_motion
    if knows == "measured":
        return (
            f"Robots that undo their own turn and displacement stand any delay; those that undo the turn alone {law}."
        )
    if knows == "turn":
        return f"Robots that undo their own turn alone stand {law}."
    return f"Robots that undo nothing of their own motion stand {law}, and that only while they are slow."


def _turning(experiment: Experiment, found: ClosedForms) -> list[str]:
    if experiment.plant == "single_integrator":
        return []
    delay, knows = experiment.scenario.sensor.delay_periods, experiment.scenario.sensor.own_motion
    limit, wheels = found.turning_limit, float(np.min(experiment.fleet.drive.speed_limit))
    limited = experiment.plant != "unicycle" or experiment.safety != "none"
    fastest = min(found.start_speed, wheels) if limited else found.start_speed
    told = []
    if knows == "unknown" and delay:
        told.append(f"Above {limit:.3g} m/s turning is unstable: commands are carried out in another frame.")
    if fastest > limit:
        told.append(
            f"Warning: the law asks for {fastest:.2f} m/s at the start; above {limit:.3g} m/s a command that is held "
            f"for {found.period:g} s turns a robot past its aim, and it may never settle."
        )
    return told


def _passages(experiment: Experiment, near: Passages) -> list[str]:
    told = [
        "Clear: how near a follower comes that starts after its neighbours settled, exactly, to those; with neighbours "
        f"within law.settled_m = {experiment.scenario.law.settled_m:g} m at least "
        f"{float(np.min(near.roughly)):.3f} m; and its way to that of the nearest other agent."
    ]
    if near.crossings:
        named = [
            f"{experiment.number(m)} crosses {experiment.number(k)}'s to {experiment.number(i)}"
            for k, i, m in near.crossings[:MOST_CROSSINGS]
        ]
        rest = len(near.crossings) - len(named)
        told.append(f"Lines of sight: agent {', '.join(named)}{f', and {rest} more' if rest else ''}.")
    return told
