"""The closed loop of the angle law as what it is, a cascade: every agent relaxes to a mean of two agents before it.

With the errors p~ of the agents from their places in the moving end configuration, as complex numbers, p~_1 = 0,

    dp~_2/dt = -r_2 p~_2,      dp~_k/dt = r_k [(1 - w_k) p~_i + w_k p~_j - p~_k]      (k >= 3, eq. (pk))

with w_k = (p*_k - p*_i) / (p*_j - p*_i), r_k = sin^2(a_k) times the follower's own gain, if it has one, and r_2 the
rate of the first follower's law near its end. In the order of the agents the matrix is lower triangular, so its
eigenvalues are its diagonal, the -r_k; it is not normal, so that norms may grow before they decay.

Everything that the theory says beyond the rates is a function of a cascade: see the other modules of this room.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from formation import agents
from formation.graph.sensing import SensingGraph
from formation.plane import Complex, Real, as_complex
from formation.target import TargetFormation

DENSE = 200
"""Agents up to which one full matrix carries the errors on; from there on it is slower than what its rows hold."""

TAYLOR_NORM = 0.5
TAYLOR_TERMS = 16
"""A matrix is halved to this norm before its exponential series, whose remainder is then below 1e-19."""


def exponential(apply: Callable[[Complex], Complex], size: int, norm: float) -> Complex:
    """(size, size) exp(A), by scaling, the power series, and squaring.

    Args:
        apply: A times an array (size, ...).
        size: rows of A.
        norm: of A, any that is not smaller than the largest sum of absolute values in a row.
    """
    halvings = max(0, int(np.ceil(np.log2(norm / TAYLOR_NORM)))) if norm > 0.0 else 0
    term = np.eye(size, dtype=np.complex128)
    result = term.copy()
    for order in range(1, TAYLOR_TERMS + 1):
        term = apply(term) / (2.0**halvings * order)
        result += term
    for _ in range(halvings):
        result = result @ result
    return result


def _terms(norm: float) -> int:
    """Terms of the exponential series of a matrix with a norm up to 1, the rest of which is below rounding."""
    size, terms = norm, 1
    while size > np.finfo(float).eps / 64.0:
        terms += 1
        size *= norm / terms
    return terms


@dataclass(frozen=True, eq=False)
class Cascade:
    """The linear closed loop of agents 2..n.

    Attributes:
        graph: the sensing graph.
        weights: (n - 2,) w_k, complex.
        rates: (n - 1,) r_2 .. r_n, 1/s; r_2 is 0 for a stationary first follower.
    """

    graph: SensingGraph
    weights: Complex
    rates: Real

    @classmethod
    def of(cls, target: TargetFormation, first_rate: float = 0.0, gains: Real | None = None) -> Cascade:
        """The cascade of eq. (u) on a target.

        Args:
            target: the target formation.
            first_rate: r_2, 1/s.
            gains: (n - 2,) gain of each follower, on top of eq. (u); 1 where absent.
        """
        p = as_complex(target.positions)
        p_i, p_j, p_k = p[target.graph.triangles].T
        own = np.sin(target.follower_angles) ** 2
        rates = np.concatenate([[first_rate], own if gains is None else own * gains])
        return cls(target.graph, (p_k - p_i) / (p_j - p_i), rates)

    @property
    def n(self) -> int:
        """Number of agents."""
        return self.graph.n

    @cached_property
    def pulls(self) -> Complex:
        """(n - 2, 2) the coefficients 1 - w_k and w_k of the neighbours i and j."""
        return np.stack([1.0 - self.weights, self.weights], axis=1)

    def apply(self, states: Complex) -> Complex:
        """dp~/dt, (n, ...), of errors (n, ...); the leader's stay as they are."""
        pulls = self.pulls.reshape(*self.pulls.shape, *(1,) * (states.ndim - 1))
        rates = self.rates.reshape(-1, *(1,) * (states.ndim - 1))
        drift = np.zeros(states.shape, dtype=np.complex128)
        drift[1:] = -rates * states[1:]
        i, j = self.graph.neighbours.T
        drift[agents.FIRST_ORDINARY :] += rates[1:] * (pulls[:, 0] * states[i] + pulls[:, 1] * states[j])
        return drift

    @cached_property
    def whole(self) -> Complex:
        """(n, n) the matrix of all agents, 1/s; the leader's row is zero."""
        return self.apply(np.eye(self.n, dtype=np.complex128))

    @property
    def matrix(self) -> Complex:
        """(n - 1, n - 1) the matrix of agents 2..n, 1/s."""
        return self.whole[1:, 1:]

    def exponential(self, duration: float) -> Complex:
        """(n, n) exp(matrix of all agents times ``duration`` seconds); a term of its series costs n^2."""
        return exponential(lambda states: self.apply(states) * duration, self.n, duration * self.norm)

    def act(self, states: Complex, duration: float) -> Complex:
        """exp(matrix of all agents times ``duration`` seconds) times states (n, ...), by series and small steps.

        A step costs what the rows of the matrix hold, n and not n^2.
        """
        norm = duration * self.norm
        parts = max(1, int(np.ceil(norm)))
        terms = _terms(norm / parts)
        rows = self.rows if states.ndim <= 2 else None
        for _ in range(parts):
            term, sum_ = states, states.astype(np.complex128)
            for order in range(1, terms + 1):
                term = (self.apply(term) if rows is None else rows @ term) * (duration / (parts * order))
                sum_ += term
            states = sum_
        return states

    @cached_property
    def rows(self) -> Any:
        """The matrix of all agents, 1/s, by what its rows hold: a sparse array of scipy."""
        from scipy.sparse import csr_array

        k, (i, j) = np.arange(agents.FIRST_ORDINARY, self.n), self.graph.neighbours.T
        own = np.arange(1, self.n)
        held = np.concatenate([-self.rates, self.rates[1:] * self.pulls[:, 0], self.rates[1:] * self.pulls[:, 1]])
        places = np.concatenate([own, k, k]), np.concatenate([own, i, j])
        return csr_array((held, places), shape=(self.n, self.n))

    @cached_property
    def norm(self) -> float:
        """The largest sum of absolute values in a row of the matrix, 1/s."""
        return float((self.rates[1:] * (1.0 + np.abs(self.pulls).sum(axis=1))).max(initial=self.rates[0]))

    @cached_property
    def late_rates(self) -> Real:
        """(n - 1,) rate, 1/s, at which each agent's error decays in the end: the slowest among itself and all upstream.

        A cascade decays no faster than its slowest part; one that stands still, r = 0, adds nothing.
        """
        late = [np.inf, np.inf if self.rates[0] == 0.0 else float(self.rates[0])]
        for (i, j), own in zip(self.graph.neighbours.tolist(), self.rates[1:].tolist(), strict=True):
            late.append(min(own, late[i], late[j]))
        return np.array(late[1:])

    @cached_property
    def reach(self) -> Real:
        """(n,) numbers c with |p~_k| <= c_k max_m(|p~_m(0)| / c_m) for all times: the errors never leave that box.

        c_k >= |1 - w_k| c_i + |w_k| c_j makes the largest |p~_k| / c_k a function that never grows.
        """
        reach = [0.0, 1.0]
        for (i, j), (a, b) in zip(self.graph.neighbours.tolist(), np.abs(self.pulls).tolist(), strict=True):
            reach.append(max(1.0, a * reach[i] + b * reach[j]))
        return np.array(reach)
