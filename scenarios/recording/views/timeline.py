"""What is the case, as states, and what happens, as events."""

from __future__ import annotations

import numpy as np
import rerun as rr

from robots.testbed import COLLISION_DISTANCE
from robots.worlds import NOTHING
from scenarios.definition.experiment import Experiment
from scenarios.measures.safety_result import NOTICEABLE
from scenarios.recording.piece import Index, Piece, Real
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import style
from scenarios.recording.views.style import Colour

EVENTS = "events"
PHASE, ACTIVE, ERRORS, DISTANCE, FLOOR, SAFETY = LANES = (
    "Phase",
    "Active",
    "Angles",
    "Separation",
    "Floor",
    "Safety",
)
"""Entities with the names that people read: the viewer heads a lane by its entity's path."""

SETTLING, AT_GOAL = "settling", "at goal"
CLEAR, CLOSE = "clear", "too close"
INSIDE, OUTSIDE = "inside", "outside"
IDLE, ACTING, RELAXED = "idle", "acting", "relaxed"


def styles(recorder: Recorder, experiment: Experiment) -> None:
    """Colours of all states."""
    names = [phase.name for phase in experiment.phases]
    _style(recorder, PHASE, names, [style.PHASES[k % len(style.PHASES)] for k in range(len(names))])
    _style(recorder, ERRORS, [SETTLING, AT_GOAL], [style.PENDING, style.GOOD])
    _style(recorder, DISTANCE, [CLEAR, CLOSE], [style.GOOD, style.BAD])
    _style(recorder, SAFETY, [IDLE, ACTING, RELAXED], [style.GOOD, style.PENDING, style.BAD])
    _style(recorder, FLOOR, [INSIDE, OUTSIDE], [style.GOOD, style.BAD])


def phases(recorder: Recorder, piece: Piece) -> None:
    """The phase under way."""
    rows = piece.changes(piece.trajectory.phase)
    t = piece.t[np.maximum(rows - 1, 0)]
    names = [piece.experiment.phases[k].name for k in piece.trajectory.phase[rows]]
    _states(recorder, PHASE, t, names)
    _events(recorder, "phases", t, [f"phase {name} begins" for name in names], rr.TextLogLevel.INFO)


def goal(recorder: Recorder, piece: Piece) -> None:
    """Whether the sum of the angle errors is below the goal."""
    below = np.less(piece.error_sum, piece.experiment.goal)
    rows = piece.changes(below)
    states = [AT_GOAL if each else SETTLING for each in below[rows]]
    _states(recorder, ERRORS, piece.t[rows], states)
    _events(recorder, "goal", piece.t[rows], [f"angles: {state}" for state in states], rr.TextLogLevel.INFO)


def activation(recorder: Recorder, piece: Piece) -> None:
    """Which agents follow the law; nothing where activation is simultaneous."""
    if piece.experiment.scenario.law.activation == "simultaneous":
        return
    active = piece.trajectory.active
    rows = piece.changes(active)
    names = [_numbers(piece.experiment, np.flatnonzero(each)) for each in active[rows]]
    _states(recorder, ACTIVE, piece.t[rows], names)
    _events(recorder, "activation", piece.t[rows], [f"active: {name}" for name in names], rr.TextLogLevel.INFO)


def safety(recorder: Recorder, piece: Piece) -> None:
    """Whether the safety filter changes a velocity, or cannot keep all distances; nothing without a filter.

    An event tells whom it acts on whenever it begins to act on anyone, and each infeasible problem when it begins.
    """
    if piece.experiment.safety == "none":
        return
    acts, relaxed = piece.trajectory.intervention > NOTICEABLE, piece.trajectory.relaxation > 0.0
    state = np.where(relaxed.any(axis=1), 2, np.where(acts.any(axis=1), 1, 0))
    rows = piece.changes(state)
    _states(recorder, SAFETY, piece.t[rows], [(IDLE, ACTING, RELAXED)[k] for k in state[rows]])
    for value, text, level in (
        (1, "safety filter acts on", rr.TextLogLevel.INFO),
        (2, "safety filter cannot keep all distances of", rr.TextLogLevel.WARN),
    ):
        begins = rows[state[rows] == value]
        whom = [_numbers(piece.experiment, np.flatnonzero((acts, relaxed)[value - 1][row])) for row in begins]
        _events(recorder, "safety", piece.t[begins], [f"{text} {each}" for each in whom], level)


def separation(recorder: Recorder, piece: Piece) -> None:
    """Whether the closest pair keeps the testbed's distance, with an event whenever it no longer does."""
    near = piece.separation
    close = np.less(near.distance, COLLISION_DISTANCE)
    rows = piece.changes(close)
    _states(recorder, DISTANCE, piece.t[rows], [CLOSE if each else CLEAR for each in close[rows]])
    begins = rows[close[rows]]
    texts = [
        f"agents {i} and {j} come within {COLLISION_DISTANCE:g} m"
        for i, j in piece.experiment.numbered(near.pairs[begins]).tolist()
    ]
    _events(recorder, "separation", piece.t[begins], texts, rr.TextLogLevel.WARN)


def contacts(recorder: Recorder, piece: Piece) -> None:
    """An event for each two agents that begin to touch, and for each that begins to touch a wall or an obstacle."""
    touched, n = piece.trajectory.contact, piece.experiment.n
    begin: dict[tuple[int, int, int], None] = {}  # row, and the two that meet there: each of them tells of it
    for agent in range(n):
        for row in piece.changes(touched[:, agent]).tolist():
            if (other := int(touched[row, agent])) != NOTHING:
                begin[row, min(agent, other), max(agent, other)] = None
    at = sorted(begin)
    texts = [
        f"{piece.experiment.name(one)} touches a wall or an obstacle"
        if other == n
        else f"agents {piece.experiment.number(one)} and {piece.experiment.number(other)} touch"
        for _, one, other in at
    ]
    _events(recorder, "contacts", piece.t[[row for row, *_ in at]], texts, rr.TextLogLevel.WARN)


def floor(recorder: Recorder, piece: Piece) -> None:
    """Whether all axle centres are on the floor, with an event for each that leaves it."""
    outside = ~piece.experiment.arena.contains(piece.trajectory.poses[..., :2])
    anyone = np.logical_or.reduce(outside, axis=1)
    rows = piece.changes(anyone)
    _states(recorder, FLOOR, piece.t[rows], [OUTSIDE if each else INSIDE for each in anyone[rows]])
    for row in range(piece.experiment.n):
        at = piece.changes(outside[:, row])
        leaves = piece.t[at[outside[at, row]]]
        _events(
            recorder,
            "floor",
            leaves,
            [f"{piece.experiment.name(row)} leaves the floor"] * len(leaves),
            rr.TextLogLevel.WARN,
        )


def _numbers(experiment: Experiment, rows: Index) -> str:
    """Agents by number, "1 to 4" where none is left out."""
    numbers = experiment.numbered(rows).tolist()
    if len(numbers) > 1 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(str(number) for number in numbers)


def _states(recorder: Recorder, entity: str, t: Real, states: list[str]) -> None:
    recorder.columns(entity, t, rr.StateChange.columns(state=states))


def _events(recorder: Recorder, kind: str, t: Real, texts: list[str], level: rr.TextLogLevel) -> None:
    levels = [str(level)] * len(texts)
    recorder.columns(f"{EVENTS}/{kind}", t, rr.TextLog.columns(text=texts, level=levels))


def _style(recorder: Recorder, entity: str, names: list[str], colours: list[Colour]) -> None:
    recorder.fixed(entity, rr.StateConfiguration(values=names, colors=colours))
