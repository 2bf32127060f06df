"""What a law does at its target: rest, what it fixes, how fast the formation returns."""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.audit.subject import REST, Finding, Subject
from formation.plane import Complex, as_complex, as_vectors

TURNS, SCALES = (0.8, -2.0), (0.7, 1.5)
"""Radians and factors of the copies of the target at which a law is asked what it leaves free."""

UNKNOWN = "cannot be told: not smooth, or not at rest, at the target"

FIXES = {
    frozenset({"orientation", "scale"}): "shape",
    frozenset({"scale"}): "shape and orientation",
    frozenset({"orientation"}): "shape and scale",
    frozenset[str](): "shape, scale and orientation",
}
"""What a law fixes, by what it leaves free."""


def rest(subject: Subject, rng: np.random.Generator) -> Finding:
    """Nobody moves where the agents stand in the target formation."""
    speed = subject.speed(subject.positions)
    holds = bool(speed.max() <= REST * subject.size)
    remark = "nobody moves" if holds else f"not for {subject.who(int(speed.argmax()))}"
    return Finding("rest at the target", holds, float(speed.max()), "m/s", remark)


def free_group(subject: Subject) -> frozenset[str] | None:
    """What a law leaves free besides the position: ``orientation``, ``scale``; None where it is not at rest at all."""
    p = subject.positions
    if not subject.speed(p).max() <= REST * subject.size:
        return None
    origin = p[agents.LEADER]

    def resting(factors: Complex) -> bool:
        copies = (origin + as_vectors(factor * as_complex(p - origin)) for factor in factors)
        return all(subject.speed(copy).max() <= REST * subject.size for copy in copies)

    kinds = {"orientation": np.exp(1j * np.array(TURNS)), "scale": np.array(SCALES, dtype=np.complex128)}
    return frozenset(kind for kind, factors in kinds.items() if resting(factors))


def fixes(subject: Subject, rng: np.random.Generator) -> Finding:
    """The similarities that take the target to other places of rest."""
    free = free_group(subject)
    if free is None:
        return Finding("what it fixes", None, remark="nothing: it is not at rest at the target")
    return Finding(
        "what it fixes",
        None,
        float(_dimension(free)),
        "free",
        f"{FIXES[free]}; free: {', '.join(['position', *sorted(free)])}",
    )


def _dimension(free: frozenset[str]) -> int:
    """Of the group of similarities: translations, and one for each of the others."""
    return 2 + len(free)


def mirror_image(subject: Subject, rng: np.random.Generator) -> Finding:
    """Whether the mirrored formation is a place of rest too, in which a run may end."""
    p = subject.positions
    origin, axis = p[agents.LEADER], as_complex(p[agents.FIRST_FOLLOWER] - p[agents.LEADER])
    mirrored = origin + as_vectors(np.conj(as_complex(p - origin) / axis) * axis)
    speed = float(subject.speed(mirrored).max())
    rests = speed <= REST * subject.size
    return Finding(
        "mirror image", None, speed, "m/s", "at rest too: runs may end there" if rests else "moves: no run ends there"
    )


def derivative(subject: Subject, rng: np.random.Generator) -> Finding:
    """The law is smooth enough at the target for its derivative to tell what happens near by."""
    loop = subject.loop
    remark = "largest error of an entry" if loop.smooth else "largest error of an entry: not smooth at the target"
    return Finding("derivative", loop.smooth, loop.bound, "1/s", remark)


def zero_modes(subject: Subject, rng: np.random.Generator) -> Finding:
    """The closed loop stands still in as many directions as the law leaves free, and in no other."""
    loop, free = subject.loop, free_group(subject)
    if not loop.smooth or free is None:
        return Finding("zero modes", False, remark=UNKNOWN)
    holds = loop.zero_modes == _dimension(free)
    return Finding("zero modes", holds, float(loop.zero_modes), f"of {2 * loop.n}", f"{_dimension(free)} are free")


def stability(subject: Subject, rng: np.random.Generator) -> Finding:
    """Every mode that moves decays."""
    loop = subject.loop
    if not loop.smooth:
        return Finding("local stability", False, remark=UNKNOWN)
    if not loop.moving.any():
        return Finding("local stability", False, 0.0, "1/s", "no mode moves: the target attracts nobody")
    rates = np.where(loop.moving, -loop.modes.real, np.inf)
    slowest = int(rates.min(axis=1).argmin())
    rate = float(rates.min())
    owner = f", {subject.who(slowest)}" if loop.cascade else ""
    word = "the slowest decay" if rate > 0.0 else "does not decay"
    return Finding("local stability", rate > 0.0, rate, "1/s", f"{word}{owner}")


def sampling(subject: Subject, control_period: float) -> Finding:
    """Commands that are held over a control period still let every mode decay."""
    if not subject.loop.smooth:
        return Finding("control period", False, remark=UNKNOWN)
    longest = subject.loop.largest_period
    remark = f"the longest that is stable; the scenario's is {control_period:g} s"
    return Finding("control period", longest > control_period, longest, "s", remark)
