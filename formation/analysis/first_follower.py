"""How the first follower moves: e_12(t) = p_2 - p_1 in closed form for each of its laws, and its rate near the end.

With e the displacement, e_0 its start and delta the one that is commanded,

    displacement   e(t) = delta + (e_0 - delta) e^{-t}                                                 rate 1
    distance       |e(t)|^2 = D^2 / (1 + (D^2 / |e_0|^2 - 1) e^{-2 D^2 t}), direction kept, D = |delta|  rate 2 D^2
    bearing        tan(phi(t) / 2) = tan(phi_0 / 2) e^{-t / |e_0|}, length kept, phi = angle from delta  rate 1 / |e_0|
    spiral         e(t) = delta exp(Log(e_0 / delta) e^{-t})                                                   rate 1

Distance and bearing are almost global: e_0 = 0, and the direction opposite to delta, are places of rest that no other
start reaches. Where delta changes, the linear law has its solution in :func:`formation.analysis.exact.steer`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from formation.laws.first_follower import logarithm
from formation.plane import Complex, Real

SETTLED = 45.0
"""Times of decay after which nothing that moves is left of e_12: e^-45 is below rounding."""


@dataclass(frozen=True)
class Motion:
    """e_12(t).

    Attributes:
        at: maps times (...), seconds, to displacements (...), complex metres.
        nearest: distance, seconds, from times not before t to the nearest singularity of e in the complex plane: over
            intervals of that length a few nodes give its integral to rounding.
    """

    at: Callable[[Real], Complex]
    nearest: Callable[[float], float] = lambda t: np.inf


LAWS = ("stationary", "displacement", "distance", "bearing", "spiral")


def motion(law: str, start: Complex, delta: complex | None) -> Motion:
    """e_12(t) from e_12(0) = ``start`` (...), metres, under the commanded ``delta``; it stays where ``delta`` is None.

    Raises:
        ValueError: ``law`` is not one of :data:`LAWS`.
    """
    if law not in LAWS:
        raise ValueError(f"first_follower must be one of {', '.join(LAWS)}, got {law!r}")
    start = np.asarray(start, dtype=np.complex128)
    if delta is None or law == "stationary":
        return Motion(lambda t: start + np.zeros_like(t))
    if law == "displacement":
        return Motion(lambda t: delta + (start - delta) * np.exp(-t))
    if law == "spiral":
        power = logarithm(start / delta)
        return Motion(
            lambda t: delta * np.exp(power * np.exp(-t)), lambda t: np.pi / (1.0 + float(np.abs(power).max()))
        )
    length = np.abs(start)
    if law == "distance":
        wanted, far = abs(delta) ** 2, float(length.max()) ** 2
        share = length**2 / wanted
        return Motion(
            lambda t: start / np.sqrt(share - (share - 1.0) * np.exp(-2.0 * wanted * t)),
            lambda t: (
                np.inf
                if t > SETTLED / (2.0 * wanted)
                else min(np.pi / (2.0 * wanted), t + (1.0 / (2.0 * far) if far else np.inf))
            ),
        )
    half = np.angle(start / delta) / 2.0
    direction = length * delta / abs(delta)

    def turning(t: Real) -> Complex:
        x = np.cos(half) + 1j * np.sin(half) * np.exp(-t / length)
        return direction * (x / np.abs(x)) ** 2

    slowest, fastest = float(length.max()), float(length.min())
    return Motion(turning, lambda t: np.inf if t > SETTLED * slowest else np.pi / 2.0 * fastest)


def rate(law: str, start: complex, delta: complex | None) -> float:
    """The rate, 1/s, at which e_12 nears its end; 0 where nothing steers it."""
    if delta is None or law == "stationary":
        return 0.0
    rates = {"displacement": 1.0, "distance": 2.0 * abs(delta) ** 2, "bearing": 1.0 / abs(start), "spiral": 1.0}
    return rates[law]
