"""What a law makes of measurements, wherever the agents are: output, memory, batches, locality, frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from formation import agents
from formation.audit.subject import REST, SAME, Finding, Measured, Subject
from formation.graph.conditions import CONDITIONS
from formation.graph.edges import edge_name
from formation.laws.protocol import needs
from formation.measurements import EACH
from formation.plane import Real

RELATIVE = "relative"
"""To the greatest speed."""


def output(subject: Subject, rng: np.random.Generator) -> Finding:
    """Velocities (n, 2), real floats, all finite."""
    expected = (subject.graph.n, 2)
    greatest = 0.0
    for points in subject.places(rng):
        u = subject.ask(*subject.measure(points))
        if u.shape != expected:
            return Finding("output", False, remark=f"expected the shape {expected}, got {u.shape}")
        if not np.issubdtype(u.dtype, np.floating):
            return Finding("output", False, remark=f"expected real floats, got {u.dtype}")
        if (bad := np.flatnonzero(~np.isfinite(u).all(axis=1))).size:
            return Finding("output", False, remark=f"not finite for {subject.who(int(bad[0]))}")
        greatest = max(greatest, float(np.abs(u).max()))
    return Finding("output", True, greatest, "m/s", "at most, seen at random places: finite floats of the right shape")


def repeats(subject: Subject, rng: np.random.Generator) -> Finding:
    """A law has no memory: the answer to one state does not change by asking for others in between."""
    asked = [subject.measure(points) for points in subject.places(rng)]
    before = np.array([subject.ask(*each) for each in asked])
    after = np.array([subject.ask(*each) for each in asked])
    change = np.linalg.norm(after - before, axis=-1).max(axis=0)
    holds = not change.any()
    remark = "no memory, bit for bit" if holds else f"a memory in {subject.who(int(change.argmax()))}"
    return Finding("same answer again", holds, float(change.max()), "m/s", remark)


def batches(subject: Subject, rng: np.random.Generator) -> Finding:
    """Several states at once give what each gives alone; a law that does not take them is called state by state."""
    points = subject.places(rng)
    apart = np.array([subject.ask(*subject.measure(each)) for each in points])
    try:
        together = subject.ask(*subject.measure(points))
    except Exception as error:  # a law need not take batches
        return Finding("batches", None, remark=f"not taken ({type(error).__name__}): states are asked one by one")
    if together.shape != apart.shape:
        return Finding("batches", None, remark=f"not taken (got {together.shape}): states are asked one by one")
    change = float(np.abs(together - apart).max())
    if change <= SAME * np.abs(apart).max():
        return Finding("batches", None, change, "m/s", "taken: many states in one call")
    return Finding("batches", None, change, "m/s", "other than state by state: states are asked one by one")


def locality(subject: Subject, rng: np.random.Generator) -> Finding:
    """No agent's velocity changes where every row that others measure is NaN, nor where it is any other number."""
    points = subject.places(rng)[0]
    measured, compass = subject.measure(points)
    whole = subject.ask(measured, compass)
    tolerance = SAME * np.linalg.norm(whole, axis=1).max()
    noise = [rng.normal(0.0, subject.size, array.shape) for array in measured]
    worst, reader = 0.0, None
    for k in range(subject.graph.n):
        strange = np.arange(subject.graph.n) != k
        poisoned = None if compass is None else np.where(strange[:, None], np.nan, compass)
        blind = subject.ask(_foreign(subject, k, measured, [np.nan] * len(measured)), poisoned)[k]
        moved = subject.ask(_foreign(subject, k, measured, noise), compass)[k]
        change = float(np.linalg.norm(moved - whole[k]))
        leaks = not np.linalg.norm(blind - whole[k]) <= tolerance
        worst = max(worst, change)
        if (leaks or change > tolerance) and reader is None:
            reader = k
    if reader is None:
        return Finding("locality", True, worst, "m/s", "no agent is moved by what others measure")
    spread = "" if worst > tolerance else ", if only its NaN"
    remark = f"{agents.name(reader)} reads {_read_by(subject, reader, measured, compass, whole[reader])}{spread}"
    return Finding("locality", False, worst, "m/s", remark)


def _foreign(subject: Subject, k: int, measured: Measured, instead: Sequence[Real | float]) -> Measured:
    """The measurements with all that agent k does not measure itself replaced."""
    replaced = []
    for kind, array, other in zip(subject.kinds, measured, instead, strict=True):
        foreign = subject.observers(kind) != k
        replaced.append(np.where(foreign.reshape(-1, *[1] * (array.ndim - 1)), other, array))
    return tuple(replaced)


def _read_by(subject: Subject, k: int, measured: Measured, compass: Real | None, whole: Real) -> str:
    """What agent k reads and does not measure: the first row whose NaN reaches it, or else a compass."""
    edges, corners = subject.graph.edges, subject.graph.corners
    for place, kind in enumerate(subject.kinds):
        for row in np.flatnonzero(subject.observers(kind) != k):
            poisoned = list(measured)
            poisoned[place] = measured[place].copy()
            poisoned[place][row] = np.nan
            if not np.allclose(subject.ask(tuple(poisoned), compass)[k], whole):
                named = [edge_name(edges[each]) for each in ([row] if EACH[kind] == "edge" else corners[row])]
                return f"edge{'s' * (len(named) > 1)} {' '.join(named)}"
    return "the compass of others"


def measurements(subject: Subject, rng: np.random.Generator) -> Finding:
    """Each kind that the law declares moves it: NaN in all of its rows is noticed."""
    measured, compass = subject.measure(subject.places(rng)[0])
    whole = subject.ask(measured, compass)
    for place, kind in enumerate(subject.kinds):
        poisoned = list(measured)
        poisoned[place] = np.full_like(measured[place], np.nan)
        if (subject.ask(tuple(poisoned), compass) == whole).all():
            return Finding("measurements", False, remark=f"declares the {kind} and does not use it")
    return Finding("measurements", True, float(len(subject.kinds)), "kinds", f"{', '.join(subject.kinds)}: all used")


def frames(subject: Subject, rng: np.random.Generator) -> Finding:
    """The motion is the same in whatever frame each agent works, each turned by its own random angle."""
    change = _change_by_frames(subject, rng, mirrored=False)
    if change.max() <= SAME:
        return Finding("local frames", True, float(change.max()), RELATIVE, "each agent may work in its own frame")
    remark = f"the frame moves {subject.who(int(change.argmax()))}"
    return Finding("local frames", False, float(change.max()), RELATIVE, remark)


def mirrored_frames(subject: Subject, rng: np.random.Generator) -> Finding:
    """The same with frames that are mirrored too: do the agents need a common sense of rotation?"""
    change = _change_by_frames(subject, rng, mirrored=True)
    free = change.max() <= SAME
    remark = "no common sense of rotation is needed" if free else "a common sense of rotation is needed"
    declared = needs(subject.law).handedness
    if declared is None:
        return Finding("mirrored frames", None, float(change.max()), RELATIVE, remark)
    word = "as declared" if declared != free else "declared otherwise"
    return Finding("mirrored frames", bool(declared != free), float(change.max()), RELATIVE, f"{remark}, {word}")


def _change_by_frames(subject: Subject, rng: np.random.Generator, mirrored: bool) -> Real:
    """(n,) greatest change of each agent's velocity, relative to the greatest speed."""
    changes = np.zeros(subject.graph.n)
    for points in subject.places(rng):
        turned = np.exp(1j * rng.uniform(-np.pi, np.pi, subject.graph.n))
        upright = subject(points)
        change = np.linalg.norm(subject(points, turned, mirrored) - upright, axis=1)
        changes = np.maximum(changes, change / max(np.linalg.norm(upright, axis=1).max(), REST * subject.size))
    return changes


def compass(subject: Subject, rng: np.random.Generator) -> Finding:
    """A law that declares a compass uses it: where it shows other directions, agents move otherwise."""
    if not subject.law.needs_compass:
        return Finding("compass", True, remark="none is declared, and none is given")
    measured, shown = subject.measure(subject.places(rng)[0])
    whole = subject.ask(measured, shown)
    used = bool((subject.ask(measured, np.full_like(whole, np.nan)) != whole).any())
    return Finding("compass", used, remark="needed, as declared" if used else "declared and not used")


def graph_kind(subject: Subject, rng: np.random.Generator) -> Finding:
    """The sensing graph is of the kind that the law declares."""
    condition = needs(subject.law).graph
    try:
        CONDITIONS[condition](subject.target)
    except ValueError as error:
        return Finding("graph", False, remark=f"declared to be {condition}: {error}")
    edges = len(subject.graph.edges)
    return Finding("graph", True, float(edges), "edges", f"{condition}, as declared")
