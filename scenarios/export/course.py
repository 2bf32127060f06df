"""The course of a script: its phases, what agents are told and when, and who stands still for a while."""

from __future__ import annotations

import math

from formation import agents
from scenarios.definition.events.event import STOP
from scenarios.definition.experiment import Experiment
from scenarios.export import pieces
from scenarios.export.listing import picked, renumbered
from scenarios.export.references import reference_text
from scenarios.export.wording import number, quoted, table


def steered(experiment: Experiment) -> bool:
    """Whether the first follower is told where to be."""
    return experiment.scenario.law.name == "angle" and experiment.first_follower != "stationary"


def course_text(experiment: Experiment) -> dict[str, str]:
    """The fields of the script that say when is what.

    Raises:
        InputError: a reference that a script cannot carry.
    """
    reference, feedforward = experiment.phases[0].reference, experiment.scenario.law.feedforward
    shapes, delta = bool(experiment.shapes), steered(experiment)
    leader, first = (experiment.number(row) for row in (agents.LEADER, agents.FIRST_FOLLOWER))
    told = ["name", "duration"]
    columns = " and its length (s)"
    constants = function = telling = ""
    if reference is None:
        told += ["velocity", *(["delta"] if delta else []), *(["shape"] if shapes else [])]
        columns = ", its length (s), the velocity of all"
        columns += f", and agent {first} as seen from agent {leader}" if delta else ""
        columns += ", and its shape" if shapes else ""
    else:
        constants, function = reference_text(experiment, experiment.phases[0])
        names = ["velocity", "factor" if delta else "_", "rate" if feedforward else "_"]
        telling = f"            {', '.join(names)} = told(t)\n" + (
            "            delta = DELTA * factor\n" if delta else ""
        )
    arguments = ["delta"] * delta + ["rate"] * feedforward + ["shape"] * shapes
    stops = [event for event in experiment.events if event.kind == STOP]
    timed = bool(stops) or reference is not None
    return {
        "columns": columns,
        "phases": table(_phases(experiment)),
        "items": ", ".join(told),
        "arguments": "".join(f", {name}" for name in arguments),
        "telling": telling,
        "clock": "    t = 0.0\n" if timed else "",
        "ticking": "            t += PERIOD\n" if timed else "",
        "reference": constants,
        "stops": _stops(experiment),
        "timed_functions": function + (_stopped(experiment) if stops else ""),
        "command": pieces.COMMAND_UNLESS_STOPPED if stops else pieces.COMMAND,
        **_angles(experiment),
    }


def _phases(experiment: Experiment) -> list[list[str]]:
    rows = []
    for index, phase in enumerate(experiment.phases):
        rows.append([quoted(phase.name), repr(phase.duration)])
        if phase.reference is not None:
            continue
        rows[-1].append(number(complex(*phase.velocity)))
        if steered(experiment) and phase.delta is not None:
            rows[-1].append(number(complex(*phase.delta)))
        if experiment.shapes:
            rows[-1].append(repr(_shape_of(experiment, index)))
    return rows


def distinct_shapes(experiment: Experiment) -> list[Experiment]:
    """Each shape of a run once, in their order."""
    return list(dict.fromkeys(experiment.shapes))


def _shape_of(experiment: Experiment, index: int) -> int:
    return distinct_shapes(experiment).index(experiment.shapes[index])


def _angles(experiment: Experiment) -> dict[str, str]:
    """The angles that are compared, with a target for each shape."""
    shapes = distinct_shapes(experiment) or [experiment]
    several = bool(experiment.shapes)
    rows = [
        (*(repr(experiment.number(row)) for row in triple), *map(repr, targets))
        for triple, *targets in zip(
            experiment.angles.triples.tolist(), *(each.target_angles.tolist() for each in shapes), strict=True
        )
    ]
    target = "angle[3:] for angle in ANGLES]).T" if several else "angle[3] for angle in ANGLES])"
    return {
        "angles_told": "# Angle at an agent, counter-clockwise from one agent to another; "
        + ("target (rad)." if not several else "its\n# target in each shape (rad)."),
        "angles": table(rows),
        "vertices": picked(experiment, "VERTEX, FROM, TO", "ANGLES", ":3"),
        "target": f"np.array([{target}",
        "shape_argument": ", shape" if several else "",
        "of_shape": "[shape]" if several else "",
        "target_item": "*targets" if several else "target",
        "last_target": "        target = targets[shape]\n" if several else "",
    }


def _stops(experiment: Experiment) -> str:
    stops = [event for event in experiment.events if event.kind == STOP]
    rows = [
        (
            repr(experiment.number(event.row)),
            repr(event.begin),
            repr(event.end) if math.isfinite(event.end) else "np.inf",
        )
        for event in stops
        if event.row is not None
    ]
    return pieces.STOPS.format(rows=table(rows)) if rows else ""


def _stopped(experiment: Experiment) -> str:
    return pieces.STOPPED.format(row="ROW[agent]" if renumbered(experiment) else "agent - 1")
