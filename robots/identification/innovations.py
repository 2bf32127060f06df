"""The Kalman filter that whitens a log: what each pose says that the turns before it did not.

The state is what a robot's odometry does not know: slip of the position x and y, slip of the heading, and the jitter of
the time between a pose and the counts that belong to it. A pose of turn k is, beyond what is linear in the numbers that
are sought,

    z_k = s_k + V_k tau_k + noise,    s_k = s_{k-1} + slip,    tau_k = rho tau_{k-1} + sqrt(1 - rho^2) sigma_tau e_k,

with V_k the pose's speed per turn. The filter's gains do not depend on data, so that several columns, the poses and the
regressors, go through it at once; least squares on what comes out is the generalised least squares of the whole log
(Harvey, "Forecasting, structural time series models and the Kalman filter", 1989, section 3.4; cited from memory, not
checked against the text).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_STATES = 4
_DIFFUSE = 1e-2  # variance of the start: columns begin at 0, so that only the first pose's noise is unknown


@compiled
def whiten(
    columns: Real, step: Real, speed: Real, known: Flags, slip: Real, noise: Real, jitter: float, memory: float
) -> tuple[Real, Real]:
    """Whitened columns and the variances they were divided by.

    Args:
        columns: (T, 3, m) of the poses' x, y, theta and of their regressors.
        speed: (T, 3) V, metres and radians per turn.
        known: (T,) whether the turn has a pose; others leave zeros.
        slip: (T, 3) variances that the slip gains on the way to each turn.
        noise: (3,) variances of a pose.
        jitter: variance of the timing, turns^2.
        memory: rho, correlation of the jitter from turn to turn.

    Returns:
        (T, 3, m) innovations divided by their standard deviations, and (T, 3) their variances.
    """
    turns, axes, m = columns.shape
    state, cov = np.zeros((_STATES, m)), np.zeros((_STATES, _STATES))
    white, variance = np.zeros((turns, axes, m)), np.ones((turns, axes))
    gain = np.zeros(_STATES)
    for i in range(axes):
        cov[i, i] = _DIFFUSE
    cov[3, 3] = jitter
    for k in range(turns):
        if k > 0:
            for j in range(m):
                state[3, j] *= memory
            for i in range(_STATES):
                cov[3, i] *= memory
            for i in range(_STATES):
                cov[i, 3] *= memory
            cov[3, 3] += jitter * (1.0 - memory * memory)
            # Where the heading has slipped, the way of the turn is turned.
            dx, dy = step[k, 0], step[k, 1]
            for j in range(m):
                state[0, j] -= dy * state[2, j]
                state[1, j] += dx * state[2, j]
            for i in range(_STATES):
                cov[0, i] -= dy * cov[2, i]
                cov[1, i] += dx * cov[2, i]
            for i in range(_STATES):
                cov[i, 0] -= dy * cov[i, 2]
                cov[i, 1] += dx * cov[i, 2]
            for i in range(axes):
                cov[i, i] += slip[k, i]
        if not known[k]:
            continue
        for i in range(axes):
            v = speed[k, i]
            for a in range(_STATES):
                gain[a] = cov[a, i] + v * cov[a, 3]
            f = noise[i] + gain[i] + v * gain[3]
            variance[k, i] = f
            root = np.sqrt(f)
            for j in range(m):
                e = columns[k, i, j] - state[i, j] - v * state[3, j]
                white[k, i, j] = e / root
                e /= f
                for a in range(_STATES):
                    state[a, j] += gain[a] * e
            for a in range(_STATES):
                for b in range(_STATES):
                    cov[a, b] -= gain[a] * gain[b] / f
    return white, variance
