"""The closed loop of eq. (man) is linear: its matrix, its eigenvalues and its exact solution.

With the errors p~ of agents 2..n from their places in the moving end configuration, as complex numbers,

    dp~_2/dt = -rho p~_2,      dp~_k/dt = g_i p~_i + g_j p~_j - sin^2(a_k) p~_k     (k >= 3, eq. (pk))

where rho is 0 for a stationary first follower and 1 for one that is steered by displacement. The matrix is lower
triangular in the order of the agents, so its eigenvalues are its diagonal: -rho and -sin^2 of the follower angles.
"""

from __future__ import annotations

import numpy as np

from formation import agents
from formation.laws.angle import follower_gains
from formation.plane import Complex, Real, as_complex, as_vectors
from formation.target import TargetFormation

FIRST_FOLLOWER_RATE = {"stationary": 0.0, "displacement": 1.0}
"""rho, 1/s, of the first-follower laws that are linear."""

TAYLOR_NORM = 0.5
TAYLOR_TERMS = 16
"""A matrix is halved to this norm before its exponential series, whose remainder is then below 1e-19."""


def closed_loop_matrix(target: TargetFormation, first_follower: str = "stationary") -> Complex:
    """(n - 1, n - 1) the matrix of the error dynamics of agents 2..n, 1/s.

    Raises:
        ValueError: the first follower's law is not linear.
    """
    if first_follower not in FIRST_FOLLOWER_RATE:
        raise ValueError(f"the closed loop is linear for {', '.join(FIRST_FOLLOWER_RATE)}, got {first_follower!r}")
    graph = target.graph
    gains = follower_gains(target)
    matrix = np.zeros((graph.n, graph.n), dtype=np.complex128)
    rows = graph.followers
    for column in (0, 1):
        matrix[rows, graph.neighbours[:, column]] = gains[:, column]
    matrix[rows, rows] = -(np.sin(target.follower_angles) ** 2)
    matrix[agents.FIRST_FOLLOWER, agents.FIRST_FOLLOWER] = -FIRST_FOLLOWER_RATE[first_follower]
    return matrix[1:, 1:]


def matrix_exponential(matrix: Complex) -> Complex:
    """exp(matrix) of a square matrix, by scaling, the power series, and squaring."""
    norm = float(np.abs(matrix).sum(axis=1).max())
    halvings = max(0, int(np.ceil(np.log2(norm / TAYLOR_NORM)))) if norm > 0.0 else 0
    scaled = matrix / 2.0**halvings
    term = np.eye(len(matrix), dtype=np.complex128)
    result = term.copy()
    for order in range(1, TAYLOR_TERMS + 1):
        term = term @ scaled / order
        result += term
    for _ in range(halvings):
        result = result @ result
    return result


def propagate(target: TargetFormation, errors: Real, duration: float, first_follower: str = "stationary") -> Real:
    """Errors (n, 2) of all agents from their moving places after ``duration`` seconds, exact; the leader's is 0."""
    later = matrix_exponential(closed_loop_matrix(target, first_follower) * duration) @ as_complex(errors)[1:]
    return as_vectors(np.concatenate([[0j], later]))


def settling_bound(
    target: TargetFormation,
    errors: Real,
    bound: float,
    first_follower: str = "stationary",
    resolution: float = 0.05,
    horizon: float = 600.0,
) -> float | None:
    """The time, seconds, after which every agent stays within ``bound`` metres of its place, to ``resolution`` seconds.

    None if that takes longer than ``horizon``, or never happens.
    """
    step = matrix_exponential(closed_loop_matrix(target, first_follower) * resolution)
    error = as_complex(errors)[1:]
    last_above = 0 if np.abs(error).max() >= bound else -1
    for k in range(1, round(horizon / resolution) + 1):
        error = step @ error
        if np.abs(error).max() >= bound:
            last_above = k
    return None if last_above == round(horizon / resolution) else (last_above + 1) * resolution


def asymptotic_rates(target: TargetFormation) -> Real:
    """(n - 2,) rate, 1/s, at which each follower's error decays in the end: the slowest among itself and all upstream.

    A cascade decays no faster than its slowest part. Stationary leader and first follower add nothing.
    """
    rates = [np.inf, np.inf]
    for (i, j), own in zip(target.graph.neighbours.tolist(), np.sin(target.follower_angles) ** 2, strict=True):
        rates.append(min(float(own), rates[i], rates[j]))
    return np.array(rates[agents.FIRST_ORDINARY :])
