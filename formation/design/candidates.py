"""Graphs side by side: how fast, how quiet, how deep each would be, and which of them nothing else beats."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from formation import agents
from formation.analysis import first_follower
from formation.analysis.cascade import Cascade
from formation.analysis.closed_loop import settling_of
from formation.analysis.margins import delay_margin
from formation.analysis.noise import bias_gains, noise_power, noise_rms
from formation.analysis.prediction import end_configuration
from formation.design.closure import TIE, best_leaders, fastest, leader_pairs, quietest, shallow
from formation.design.field import Choice, Field
from formation.maneuver import Phase, pair_ends
from formation.plane import Real, as_complex

SHALLOW_RATES = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.97)
"""1/s, at which a shallow graph is looked for."""

QUIET_RATES = (0.1, 0.3, 0.5)
"""1/s, below which a quiet graph has no follower."""

FEW_RATES = {"shallow": (0.8, 0.9, 0.95), "quiet": (0.5,)}
"""Those of more than :data:`MANY` agents."""

FINALISTS = 6
"""Of the leaders that look best for one kind of graph, how many are computed through; one of more than :data:`MANY`."""

FINE, COARSE = 0.05, 0.5
"""Seconds to which settling is told, of up to :data:`MANY` agents and of more."""

MANY = 200


@dataclass(frozen=True, eq=False)
class Task:
    """What a graph is chosen for.

    Attributes:
        start: (n, 2) where the agents are, metres.
        law: of the first follower, a name of :data:`formation.EDGE_LAWS`.
        factor: c e^{i theta} of the commanded end: delta_12 over the difference of the same two agents in the target.
        period: control period, seconds.
        bound: metres within which an agent has arrived.
    """

    start: Real
    law: str = "stationary"
    factor: complex = 1.0 + 0j
    period: float = 0.033
    bound: float = 0.01

    @property
    def steered(self) -> bool:
        """Whether the first follower moves, and so has to sense the leader."""
        return self.law != "stationary"


@dataclass(frozen=True, eq=False)
class Candidate:
    """One graph and what it promises.

    Attributes:
        name: how it was found.
        choice: the graph.
        rate: of its slowest follower, 1/s.
        settling: seconds until every agent of the task stays within its bound; None if that takes longer than 10 min.
        noise: largest root mean square error of an agent over the standard deviation of a measured coordinate.
        bias: largest offset of an agent over independent constant errors of all measurements.
        delay_margin: of all measurements, seconds.
        sensed_by: by how many others the agent is sensed that is sensed by the most.
    """

    name: str
    choice: Choice
    rate: float
    settling: float | None
    noise: float
    bias: float
    delay_margin: float
    sensed_by: int

    @property
    def depth(self) -> int:
        """Of the cascade."""
        return int(self.choice.depth.max())


def evaluate(name: str, field: Field, task: Task, choice: Choice) -> Candidate:
    """All figures of a graph."""
    target, start = choice.target(field.positions), task.start[choice.order]
    star = as_complex(target.positions[: agents.FIRST_ORDINARY])
    delta = task.factor * complex(star[1] - star[0])
    e = complex(as_complex(start[agents.FIRST_FOLLOWER]) - as_complex(start[agents.LEADER]))
    phase = Phase("", 1.0, delta=(delta.real, delta.imag))
    end = end_configuration(target, *pair_ends(start, [phase], task.law)[0])
    loop = Cascade.of(target, first_follower.rate(task.law, e, delta))
    resolution = FINE if field.n <= MANY else COARSE
    sensed = np.bincount(target.graph.edges[0 if task.steered else 1 :, 1], minlength=field.n)
    return Candidate(
        name=name,
        choice=choice,
        rate=float(loop.rates[1:].min()),
        settling=settling_of(loop, start - end, task.bound, resolution),
        noise=float(noise_rms(loop, task.period, noise_power(loop, target.positions, 1.0)).max()),
        bias=float(bias_gains(loop).max()),
        delay_margin=delay_margin(-loop.rates[loop.rates > 0.0]),
        sensed_by=int(sensed.max()),
    )


def propose(field: Field, task: Task, leaders: tuple[int, int] | None) -> list[Candidate]:
    """Candidates of every kind, best settling first; none where nothing reaches every agent.

    Args:
        field: places and allowed edges.
        task: what for.
        leaders: rows of the leader and of the first follower; None to choose them too.
    """
    found: dict[bytes, Candidate] = {}
    for name, choice in _kinds(field, task, leaders):
        key = choice.order.tobytes() + choice.pairs.tobytes()
        if choice.whole and key not in found and _is_nondegenerate(choice, field.positions):
            found[key] = evaluate(name, field, task, choice)
    return sorted(found.values(), key=lambda each: (np.inf if each.settling is None else each.settling, each.noise))


def _is_nondegenerate(choice: Choice, positions: Real) -> bool:
    """Whether the places are a target for a graph: a triangle that is not flat may be flatter than Assumption 2 has."""
    try:
        choice.target(positions)
    except ValueError:
        return False
    return True


def unbeaten(candidates: list[Candidate]) -> list[Candidate]:
    """Those that no other beats in settling and in noise (Pareto)."""

    def beats(one: Candidate, other: Candidate) -> bool:
        a, b = (np.inf if each.settling is None else each.settling for each in (one, other))
        return a <= b and one.noise <= other.noise and (a, one.noise) != (b, other.noise)

    return [each for each in candidates if not any(beats(other, each) for other in candidates)]


def choose(candidates: list[Candidate], objective: str) -> Candidate:
    """The best: ``settling``, ``noise``, or ``both``, the least product of the two among the unbeaten."""

    def settling(each: Candidate) -> float:
        return np.inf if each.settling is None else each.settling

    keys = {
        "settling": lambda each: (settling(each), each.noise),
        "noise": lambda each: (each.noise, settling(each)),
        "both": lambda each: (settling(each) * each.noise, settling(each)),
    }
    return min(unbeaten(candidates), key=keys[objective])


def _kinds(field: Field, task: Task, leaders: tuple[int, int] | None) -> Iterator[tuple[str, Choice]]:
    pairs = list(leader_pairs(field, task.steered)) if leaders is None else [leaders]
    many = field.n > MANY
    best = best_leaders(field, task.steered) if leaders is None and not many else None
    if best is not None:
        yield "best rate, shallow", best[1]
        yield "best rate", fastest(field, best[1].leaders)[1]
    if leaders is not None:
        rate, choice = fastest(field, leaders)
        yield "best rate, shallow", shallow(field, leaders, rate - TIE)
        yield "best rate", choice
    for rate in FEW_RATES["shallow"] if many else SHALLOW_RATES:
        choices = [choice for each in pairs if (choice := shallow(field, each, rate)).whole]
        choices.sort(key=lambda choice: (choice.depth.max(), choice.depth.mean()))
        for choice in choices[: 1 if many else FINALISTS]:
            yield f"shallow {rate:g}", choice
            yield f"shallow, quiet {rate:g}", shallow(field, choice.leaders, rate, quiet=True)
    for rate in FEW_RATES["quiet"] if many else QUIET_RATES:
        quiet = [quietest(field, each, rate, task.period, task.steered) for each in pairs[: 1 if many else None]]
        quiet = sorted((each for each in quiet if each[1].whole), key=lambda each: each[0])
        for _, choice in quiet[: 1 if many else FINALISTS]:
            yield f"quiet {rate:g}", choice
