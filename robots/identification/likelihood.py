"""How likely a log is, as a function of its noises; the linear numbers are solved for on the way.

With whitened residuals e and variances F of what the filter puts out, and the information M about the linear numbers,
the restricted log-likelihood is -(e.e + sum log F + log det M) / 2: the last term makes up for what the linear numbers
take of the noise (Patterson and Thompson 1971; cited from memory, not checked against the text). Further,

    I_ij = sum (d_i v d_j v / F + d_i log F d_j log F / 2)

is the expected information about the noises, of first derivatives alone (v = e sqrt(F)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.identification.design import Design

Real = NDArray[np.float64]

LOGARITHMIC = ("position_noise", "heading_noise", "slip_along", "slip_heading", "slip_turning", "jitter")
"""Noises that enter by their logarithm; jitter_memory, the last one, enters by its inverse hyperbolic tangent."""

AXES = 3
"""Of a pose: x, y, theta."""

_MEMORY = 6  # turns over which what the model leaves out may be correlated (Newey and West 1987, likewise from memory)

_STEP = 1e-6  # of a noise's parameter, for differences
_FARTHEST = 30.0  # of a logarithm: keeps the optimiser's trials finite


@dataclass(frozen=True, eq=False)
class Whitened:
    """A design at some noises.

    Attributes:
        residuals: whitened, of all poses that are known but the first.
        log_variance: of the same.
        linear: the numbers of :data:`robots.identification.design.COLUMNS`.
        information: of those numbers; its inverse is their covariance.
    """

    residuals: Real
    log_variance: Real
    linear: Real
    information: Real


class Likelihood:
    """Minus the logarithm of the likelihood, its slope and its expected curvature, for scipy's minimisers.

    Args:
        design: the log, made linear.
        heading_quantum: step to which the headings are rounded, radians: adds q^2 / 12 to their variance.
    """

    def __init__(self, design: Design, heading_quantum: float) -> None:
        self._design, self._rounding = design, heading_quantum**2 / 12.0
        self._at: Real | None = None
        self._slope, self._curvature, self._scatter = np.empty(0), np.empty((0, 0)), np.empty((0, 0))

    def whitened(self, noises: Real) -> Whitened:
        from robots.identification.innovations import whiten  # numba is loaded only where a log is identified

        design = self._design
        deviation = np.exp(np.clip(noises[:-1], -_FARTHEST, _FARTHEST))
        position, heading, along, drifting, turning, jitter = (deviation**2).tolist()
        slip = np.column_stack([along * design.driven] * 2 + [drifting * design.driven + turning * design.turned])
        white, variance = whiten(
            design.columns,
            design.step,
            design.speed,
            design.way.known,
            slip,
            np.array([position, position, heading + self._rounding]),
            jitter,
            float(np.tanh(noises[-1])),
        )
        rows = design.way.known.copy()
        rows[: int(rows.argmax()) + 1] = False  # the first pose says where the robot starts, no more
        flat = white[rows].reshape(-1, white.shape[2])
        regressors = flat[:, 1:]
        information = regressors.T @ regressors
        linear: Real = np.linalg.solve(information, regressors.T @ flat[:, 0]).astype(np.float64)
        return Whitened(flat[:, 0] - regressors @ linear, np.log(variance[rows].ravel()), linear, information)

    def value(self, noises: Real) -> float:
        white = self.whitened(noises)
        return float(white.residuals @ white.residuals + white.log_variance.sum() + _log_det(white)) / 2.0

    def slope(self, noises: Real) -> Real:
        self._differentiate(noises)
        return self._slope

    def curvature(self, noises: Real) -> Real:
        self._differentiate(noises)
        return self._curvature

    def deviations(self, noises: Real) -> Real:
        """Standard deviations of the noises' parameters: the larger of two.

        One is right where the noises are normal and the model holds; the other, from the scatter of the slopes that the
        turns contribute, also where they are not (White 1982; cited from memory, not checked against the text).
        """
        self._differentiate(noises)
        covariance = np.linalg.pinv(self._curvature)
        robust = covariance @ self._scatter @ covariance
        return np.asarray(np.sqrt(np.maximum(np.diag(covariance), np.diag(robust))))

    def _differentiate(self, noises: Real) -> None:
        if self._at is not None and np.array_equal(self._at, noises):
            return
        white = self.whitened(noises)
        de, df = np.empty((2, len(noises), white.residuals.size))
        restriction = np.empty(len(noises))
        for i in range(len(noises)):
            moved = np.array(noises)
            moved[i] += _STEP
            other = self.whitened(moved)
            de[i] = (other.residuals - white.residuals) / _STEP
            df[i] = (other.log_variance - white.log_variance) / _STEP
            restriction[i] = (_log_det(other) - _log_det(white)) / _STEP
        self._at = np.array(noises)
        slopes = de * white.residuals + df / 2.0
        self._slope = slopes.sum(axis=1) + restriction / 2.0
        turns = slopes.reshape(len(noises), -1, AXES).sum(axis=2)
        self._scatter = turns @ turns.T
        for after in range(1, _MEMORY + 1):
            together = (1.0 - after / (_MEMORY + 1)) * (turns[:, after:] @ turns[:, :-after].T)
            self._scatter += together + together.T
        dv = de + white.residuals * df / 2.0
        self._curvature = dv @ dv.T + df @ df.T / 2.0


def _log_det(white: Whitened) -> float:
    return float(np.linalg.slogdet(white.information)[1])
