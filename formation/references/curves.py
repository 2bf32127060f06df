"""Closed curves: a leader that comes round and round, and a formation that turns with its path or does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from formation.plane import Complex, Real
from formation.references.protocol import NO_BENDS

SAMPLES = 4096
"""Points at which the length of a closed path is summed: exact to rounding, as the path is smooth and periodic."""


Shape = Callable[[Real, complex], tuple[Complex, Complex, Complex]]
"""Maps phi (...) and the half axes a + ib of a closed path to P, dP/dphi and its second derivative."""


def ellipse(phi: Real, half: complex) -> tuple[Complex, Complex, Complex]:
    """a sin(phi) + i b (1 - cos(phi)): begins along its width, its centre to the left; a circle where a = b."""
    a, b = half.real, half.imag
    sine, cosine = np.sin(phi), np.cos(phi)
    return a * sine + 1j * b * (1.0 - cosine), a * cosine + 1j * b * sine, -a * sine + 1j * b * cosine


def figure_eight(phi: Real, half: complex) -> tuple[Complex, Complex, Complex]:
    """a sin(phi) + i b sin(2 phi), the lemniscate of Gerono: begins in its crossing."""
    a, b = half.real, half.imag
    sine, cosine, sine_2, cosine_2 = np.sin(phi), np.cos(phi), np.sin(2.0 * phi), np.cos(2.0 * phi)
    return a * sine + 1j * b * sine_2, a * cosine + 2j * b * cosine_2, -a * sine - 4j * b * sine_2


CURVES: dict[str, Shape] = {"circle": ellipse, "ellipse": ellipse, "figure-eight": figure_eight}
"""Closed paths by the names that scenario files use."""


@dataclass(frozen=True)
class ClosedCurve:
    """A leader on a closed path, phi = 2 pi t / period, and a formation that turns with the path or does not.

    Attributes:
        shape: a name of :data:`CURVES`.
        size: width and height of the path, metres, both positive.
        period: seconds for one round.
        direction: of the path's width in the common frame, radians.
        clockwise: whether the path is run through mirrored at its width, so that it bends to the right first.
        turning: whether the formation turns as the path does; it keeps its orientation otherwise.
    """

    shape: str
    size: tuple[float, float]
    period: float
    direction: float = 0.0
    clockwise: bool = False
    turning: bool = True

    def __post_init__(self) -> None:
        if self.shape not in CURVES:
            raise ValueError(f"shape must be one of {', '.join(CURVES)}, got {self.shape!r}")
        if not (min(self.size) > 0.0 and self.period > 0.0):
            raise ValueError(f"size and period must be positive, got {self.size} and {self.period:g}")

    @property
    def cycle(self) -> float | None:
        """One round: the turn of the tangent is a multiple of a full turn."""
        return self.period

    @property
    def bends(self) -> Real:
        return NO_BENDS

    @property
    def angular_rate(self) -> float:
        """d phi / dt, rad/s."""
        return 2.0 * np.pi / self.period

    def path(self, t: Real | float) -> Complex:
        return self._derivatives(t)[0]

    def velocity(self, t: Real | float) -> Complex:
        return self.angular_rate * self._derivatives(t)[1]

    def factor(self, t: Real | float) -> Complex:
        if not self.turning:
            return np.ones(np.shape(t), dtype=np.complex128)
        tangent, first = self._derivatives(t)[1], self._derivatives(0.0)[1]
        turned = tangent * np.conj(first)
        return np.asarray(turned / np.abs(turned), dtype=np.complex128)

    def rate(self, t: Real | float) -> Complex:
        if not self.turning:
            return np.zeros(np.shape(t), dtype=np.complex128)
        _, tangent, bend = self._derivatives(t)
        return np.asarray(1j * self.angular_rate * (bend / tangent).imag, dtype=np.complex128)

    def _derivatives(self, t: Real | float) -> tuple[Complex, Complex, Complex]:
        return _at(self, t) if isinstance(t, float) else _derivatives(self, t)


def _derivatives(curve: ClosedCurve, t: Real | float) -> tuple[Complex, Complex, Complex]:
    """P and its first two derivatives by phi at times t (...)."""
    phi = curve.angular_rate * np.asarray(t, dtype=np.float64)
    aim = np.exp(1j * curve.direction)
    found = CURVES[curve.shape](phi, complex(*curve.size) / 2.0)
    p, v, a = (aim * (np.conj(each) if curve.clockwise else each) for each in found)
    return p, v, a


@lru_cache(maxsize=2)
def _at(curve: ClosedCurve, t: float) -> tuple[Complex, Complex, Complex]:
    """The same at one time; a runner asks for velocity, turn and rate of each in turn, and for the turn since 0."""
    return _derivatives(curve, t)


def curve_length(shape: str, size: tuple[float, float]) -> float:
    """The length of a closed path of :data:`CURVES`, metres."""
    phi: Real = np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False)
    return float(np.abs(CURVES[shape](phi, complex(*size) / 2.0)[1]).mean() * 2.0 * np.pi)
