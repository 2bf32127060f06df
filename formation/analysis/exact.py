"""The exact motion of ideal agents under eq. (man), instant by instant, and that of commands held over a period.

Relative to the leader the followers are a linear cascade that the displacement e(t) = p_2 - p_1 drives, whatever
moves it:

    dq_F/dt = M_F q_F + b e(t),     q_F(t + h) = e^{M_F h} q_F(t) + int_0^h e^{M_F (h - s)} b e(t + s) ds.

With e known in closed form the integral is a Gauss-Legendre sum, exact to rounding. On a reference a first follower by
displacement is one more agent of the cascade, de/dt = delta(t) - e, that delta(t) drives in the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate, count, islice, pairwise, repeat, tee

import numpy as np

from formation import agents
from formation.analysis.cascade import DENSE, Cascade, exponential
from formation.analysis.first_follower import Motion, motion
from formation.laws.first_follower import EDGE_LAWS
from formation.maneuver import Phase
from formation.plane import Complex, Real, as_vectors
from formation.references.protocol import NO_BENDS

NODES = 8
LONGEST_STEP = 0.1
"""Seconds: over this, and over no more than the nearest singularity of e(t) is away, the nodes err below rounding."""

KEPT = 64
"""Stretches that are kept for the next phase of the same loop: many short phases have few lengths."""

ROW = agents.FIRST_ORDINARY

NEGLIGIBLE = 1e-9
"""Share of a step within which of its ends a bend counts as there."""


def follow(cascade: Cascade, start: Complex, first: Motion, step: float) -> Iterator[Complex]:
    """Where the agents are relative to the leader, complex metres (n, ...), at time 0 and every ``step`` seconds.

    Args:
        cascade: of the followers; the first follower's own rate is not used.
        start: (n, ...) positions at time 0, complex metres; further dimensions are so many motions at once.
        first: e_12(t) (...), the displacement of agent 2 from agent 1.
        step: seconds.
    """
    q = start - start[agents.LEADER]
    for index in count(1):
        yield q
        begin, state = step * (index - 1), q[ROW:]
        done = 0.0  # share of the step; sums of halves are exact
        while done < 1.0:
            longest = min(LONGEST_STEP, first.nearest(begin + done * step))
            halvings = max(0, int(np.ceil(np.log2(step / longest))))
            while done + 0.5**halvings > 1.0:
                halvings += 1
            state = _Stretch.over(cascade, step * 0.5**halvings, ROW).advance(state, first.at, begin + done * step)
            done += 0.5**halvings
        q = np.empty_like(q)
        q[agents.LEADER], q[agents.FIRST_FOLLOWER], q[ROW:] = 0.0, first.at(np.asarray(step * index)), state


def steer(
    cascade: Cascade,
    start: Complex,
    delta: Callable[[Real], Complex],
    bends: Real,
    step: float,
    begin: float,
    velocities: Iterable[Complex] | None = None,
) -> Iterator[Complex]:
    """Likewise behind a first follower by displacement, while the displacement that it is told changes.

    Args:
        cascade: its first follower's rate is 1, or 0 where it stands still.
        start: (n,) or (n, k) positions at ``begin``, complex metres.
        delta: maps times (...), seconds, to displacements (...), complex metres.
        bends: times at which delta is not smooth, increasing.
        step: seconds.
        begin: seconds.
        velocities: (n,) of each step, complex m/s, what each agent takes v_r for, as many as steps; all take the same
            where absent, and then it never ends.
    """
    q, steered = start - start[agents.LEADER], agents.FIRST_FOLLOWER
    own = repeat(None) if velocities is None else iter(velocities)
    for index, velocity in enumerate(own, start=1):
        yield q
        low, high = begin + step * (index - 1), begin + step * index
        inside = bends[(bends > low + NEGLIGIBLE * step) & (bends < high - NEGLIGIBLE * step)].tolist()
        state = q[steered:]
        for edge, following in pairwise([low, *inside, high]):
            length = following - edge if inside else step
            parts = max(1, int(np.ceil(length / LONGEST_STEP)))
            for part in range(parts):
                stretch = _Stretch.over(cascade, length / parts, steered)
                state = stretch.advance(state, delta, edge + part * length / parts)
        if velocity is not None:
            offset = (velocity - velocity[agents.LEADER])[steered:]
            state = state + (_summed(cascade, step)[steered:, steered:] @ offset).reshape(-1, *(1,) * (state.ndim - 1))
        q = np.concatenate([np.zeros_like(q[:steered]), state])
    yield q


@lru_cache(maxsize=KEPT)
def _summed(cascade: Cascade, h: float) -> Complex:
    """(n, n) the integral of e^{M s} from 0 to h: what velocities of 1 m/s that are held for so long come to."""
    n = cascade.n
    whole = np.zeros((2 * n, 2 * n), dtype=np.complex128)
    whole[:n, :n], whole[:n, n:] = cascade.whole, np.eye(n)
    return exponential(lambda states: (whole @ states) * h, 2 * n, h * (cascade.norm + 1.0))[:n, n:]


@dataclass(frozen=True, eq=False)
class _Stretch:
    """One exact step of the agents that something drives: e^{M h}, and what each node of the quadrature adds.

    Of few agents e^{M h} is a matrix; of many only what it does to a state is ever known.
    """

    cascade: Cascade
    h: float
    forward: Complex | None
    nodes: Real
    kernels: Complex

    @classmethod
    @lru_cache(maxsize=KEPT)
    def over(cls, cascade: Cascade, h: float, row: int) -> _Stretch:
        """Of the agents from ``row`` on: those behind the first follower, or with it, at its rate."""
        roots, weights = np.polynomial.legendre.leggauss(NODES)
        nodes = (roots + 1.0) * (h / 2.0)
        driven = _driven(cascade, row)
        if cascade.n > DENSE:
            kernels = np.stack([cascade.act(driven, h - node)[row:] for node in nodes], axis=1)
            return cls(cascade, h, None, nodes, kernels * (weights * (h / 2.0)))
        kernels = np.stack([cascade.exponential(h - node)[row:, row:] @ driven[row:] for node in nodes], axis=1)
        return cls(cascade, h, cascade.exponential(h)[row:, row:], nodes, kernels * (weights * (h / 2.0)))

    def advance(self, state: Complex, drive: Callable[[Real], Complex], begin: float) -> Complex:
        """The driven agents' ``state`` after the stretch that begins at ``begin`` seconds."""
        times = begin + self.nodes.reshape(-1, *(1,) * (state.ndim - 1))
        if self.forward is not None:
            return self.forward @ state + self.kernels @ drive(times)
        still = np.zeros((self.cascade.n - len(state), *state.shape[1:]), dtype=np.complex128)
        onward = self.cascade.act(np.concatenate([still, state]), self.h)[len(still) :]
        return onward + np.einsum("kq,q...->k...", self.kernels, drive(times))


def _driven(cascade: Cascade, row: int) -> Complex:
    """(n,) what 1 m of the drive does each second to the agents from ``row`` on."""
    if row == agents.FIRST_FOLLOWER:
        return cascade.rates[0] * np.eye(1, cascade.n, row, dtype=np.complex128)[0]
    driven = cascade.apply(np.eye(1, cascade.n, agents.FIRST_FOLLOWER, dtype=np.complex128)[0])
    driven[:ROW] = 0.0
    return driven


def ideal(
    cascade: Cascade, start: Complex, phase: Phase, first_follower: str, step: float, begin: float = 0.0
) -> Iterator[Complex]:
    """Where a phase takes ideal agents from ``start`` (n, ...), complex metres, at its start and every ``step`` s.

    On a reference, which begins so many seconds into it, the first follower stands still or is steered by displacement.
    """
    leader, delta = start[agents.LEADER], phase.displacement
    if phase.reference is None or delta is None or first_follower == "stationary":
        first = motion(first_follower, start[agents.FIRST_FOLLOWER] - leader, delta)
        moved = follow(cascade, start, first, step)
    else:
        moved = steer(*_steered(cascade, start, phase, first_follower), step, begin)
    for index, q in enumerate(moved):
        yield q + (leader + _way(phase, begin, step * index))


def informed(
    cascade: Cascade,
    start: Complex,
    phase: Phase,
    first_follower: str,
    period: float,
    velocities: Iterable[Complex],
    begin: float = 0.0,
) -> Iterator[Complex]:
    """The same where each agent moves with what it takes v_r for, (n,) of each period, complex m/s, held meanwhile.

    The first follower stands still or is steered by displacement.
    """
    own, first = tee(velocities)
    moved = steer(*_steered(cascade, start, phase, first_follower), period, begin, own)
    leaders = accumulate((velocity[agents.LEADER] * period for velocity in first), initial=start[agents.LEADER])
    for q, leader in zip(moved, leaders, strict=False):
        yield q + leader


def _steered(
    cascade: Cascade, start: Complex, phase: Phase, first_follower: str
) -> tuple[Cascade, Complex, Callable[[Real], Complex], Real]:
    """The arguments of :func:`steer` of a phase, whose first follower stands still or is steered by displacement."""
    reference, delta = phase.reference, phase.displacement
    if delta is None or first_follower == "stationary":
        return cascade, start, np.zeros_like, NO_BENDS
    loop = Cascade(cascade.graph, cascade.weights, np.concatenate([[1.0], cascade.rates[1:]]))
    if reference is None:
        return loop, start, lambda t: np.full_like(t, delta, dtype=np.complex128), NO_BENDS
    return loop, start, lambda t: delta * reference.factor(t), reference.bends


def _way(phase: Phase, begin: float, elapsed: float) -> complex:
    """How far the leader comes in so many seconds after ``begin``, complex metres."""
    if phase.reference is None:
        return complex(*phase.velocity) * elapsed
    return complex(phase.reference.path(begin + elapsed) - phase.reference.path(begin))


def held(
    cascade: Cascade,
    start: Complex,
    phase: Phase,
    first_follower: str,
    period: float,
    begin: float = 0.0,
    velocities: Iterable[Complex] | None = None,
) -> Iterator[Complex]:
    """The same where each command is held over a control period, seconds, as a digital controller does.

    The points go straight while a command is held: those of wheeled robots do so once they are slow. ``velocities`` are
    what each agent takes v_r for, as in :func:`informed`; v_r where absent.
    """
    delta, velocity, reference = phase.displacement, complex(*phase.velocity), phase.reference
    law = EDGE_LAWS["stationary" if delta is None else first_follower]
    shape = Cascade(cascade.graph, cascade.weights, np.concatenate([[0.0], cascade.rates[1:]]))
    p, told = start, delta or 0j
    for index, own in enumerate(repeat(None) if velocities is None else velocities):
        yield p
        if reference is not None:
            velocity = complex(reference.velocity(begin + period * index))
            told = (delta or 0j) * complex(reference.factor(begin + period * index))
        u = shape.apply(p)
        u[agents.FIRST_FOLLOWER] = law(p[agents.FIRST_FOLLOWER] - p[agents.LEADER], np.asarray(told))
        p = p + period * (u + (velocity if own is None else own))
    yield p


def points(states: Iterator[Complex], steps: int) -> Real:
    """(steps + 1, n, 2) the first states of one motion, metres."""
    return as_vectors(np.stack(list(islice(states, steps + 1))))


def spread(cascade: Cascade, row: int, own: Complex, t: Real) -> Complex:
    """(T, n) the errors that a stopped agent spreads down the cascade, at times t (T,), complex metres.

    The loop is linear, so the errors e = p - p' that a stop makes, p' being the motion without it, obey the loop's own
    equation for every agent but the stopped one, s, which stays where it was:

        e_s(t) = p'_s(0) - p'_s(t),       de_k/dt = r_k [(1 - w_k) e_i + w_k e_j - e_k],   k != s,   e(0) = 0.

    Of a formation that moves on at v_r, e_s = -v_r t. Once that has lasted, e_k = -(g_k t - h_k) v_r with g_s = 1,
    h_s = 0, g_k = (1 - w_k) g_i + w_k g_j and h_k = (1 - w_k) h_i + w_k h_j + g_k / r_k: agents that sense s, directly
    or not, are g_k times as far off as s is, less what they lag behind; nobody else notices.

    Args:
        cascade: the closed loop, with the first follower's own rate.
        row: of the stopped agent.
        own: (T,) its own error at these times, from 0 on; taken to be piecewise linear.
        t: (T,) seconds, from the stop on.
    """
    n = cascade.n
    loop = cascade.whole.copy()
    loop[row] = 0.0
    whole = np.zeros((n + 1, n + 1), dtype=np.complex128)  # the last component is the slope of e_s
    whole[:n, :n], whole[row, n] = loop, 1.0
    errors = np.zeros((len(t), n), dtype=np.complex128)
    steps: dict[float, Complex] = {}
    for k, h in enumerate(np.diff(t).tolist(), start=1):
        if h not in steps:
            norm = float(np.abs(whole * h).sum(axis=1).max())
            steps[h] = exponential(lambda states, h=h: (whole @ states) * h, n + 1, norm)  # type: ignore[misc]
        slope = (own[k] - own[k - 1]) / h
        errors[k] = (steps[h] @ np.append(errors[k - 1], slope))[:n]
        errors[k, row] = own[k]
    return errors
