"""The course of a scenario: its phases, or its reference, with the displacement of agents 1 and 2 in each."""

from __future__ import annotations

from formation import LAWS, Framework, Phase, agents
from scenarios.definition.references import build_reference
from scenarios.definition.schema import Scenario
from scenarios.errors import InputError


def phases(path: str, scenario: Scenario, formation: Framework, duration: float | None) -> tuple[Phase, ...]:
    """The maneuver, cut or extended to ``duration``; one phase named after the law's aim where no phases are given."""
    deltas = _displacements(path, scenario, formation)
    if scenario.reference is not None:
        reference = build_reference(path, scenario.reference)
        velocity = complex(reference.velocity(0.0))
        length = duration or scenario.duration_s or 0.0
        return (Phase(scenario.reference.kind, length, (velocity.real, velocity.imag), deltas[0], reference),)
    if not scenario.phases:
        return (Phase("shape", duration or scenario.duration_s or 0.0, delta=deltas[0]),)
    phases, elapsed = [], 0.0
    for table, delta in zip(scenario.phases, deltas, strict=True):
        length = table.duration_s
        if duration is not None:
            last = table is scenario.phases[-1]
            length = duration - elapsed if last else min(length, duration - elapsed)
        if length > 0.0:
            phases.append(Phase(table.name, length, table.velocity_m_s, delta))
        elapsed += length
    return tuple(phases)


def _displacements(path: str, scenario: Scenario, formation: Framework) -> list[tuple[float, float] | None]:
    """delta_12 of each phase: the scenario's, or that of p* for a law that takes its own from the target."""
    if scenario.reference is not None:
        given = [scenario.reference.displacement_m]
    else:
        given = [phase.displacement_m for phase in scenario.phases] or [None]
    for number, delta in enumerate(given, start=1):
        if delta is not None and not any(delta):
            field = "reference" if scenario.reference is not None else f"phases[{number}]"
            raise InputError(f"{path}: {field}.displacement_m: agents 1 and 2 must not be sent to one place")
    if scenario.law.name == "own":
        return given
    if scenario.law.name != "angle":
        if not LAWS[scenario.law.name].steers:
            if any(delta is not None for delta in given):
                field = "phases" if scenario.reference is None else "reference"
                raise InputError(f"{path}: {field}.displacement_m: the {scenario.law.name} law follows none")
            return given
        return [_of_target(formation) if delta is None else delta for delta in given]
    if scenario.law.first_follower == "stationary":
        return given
    if scenario.reference is not None:
        return [given[0] or _of_target(formation)]
    if not scenario.phases:
        raise InputError(f"{path}: law.first_follower: {scenario.law.first_follower!r} needs phases to follow")
    for number, delta in enumerate(given, start=1):
        if delta is None:
            raise InputError(f"{path}: phases[{number}].displacement_m: missing")
    return given


def _of_target(formation: Framework) -> tuple[float, float]:
    """p*_2 - p*_1, metres."""
    x, y = formation.positions[agents.FIRST_FOLLOWER] - formation.positions[agents.LEADER]
    return float(x), float(y)
