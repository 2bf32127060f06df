"""What a robot knows of its own motion since a measurement was taken: gyro and encoders.

A measurement that is d control periods old is of another frame and from another place. A robot that carries it into
today's frame undoes its own turn, one that carries it to today's place too undoes its own displacement; what is left is
the others' motion alone. A command that was computed in the frame of then and is carried out in the frame of now is
turned by what the robot turned meanwhile: along a constant velocity v the heading of the projected point at the
distance l follows dphi/dt = -(v / l) sin(phi(t - tau)), which is stable for v tau / l < pi / 2 only, see
:meth:`robots.nid.NearIdentityDiffeomorphism.turning_limit`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

UNKNOWN, TURN, MEASURED = "unknown", "turn", "measured"
KNOWLEDGE = (UNKNOWN, TURN, MEASURED)
"""What a robot may know: nothing, its turn, its turn and its displacement."""


@dataclass(frozen=True, eq=False)
class Sensed:
    """The state as robots sense it now: relative positions are ``others`` minus ``own``, in the frames ``headings``.

    Attributes:
        own: (..., n, 2) where each robot is, or was, as far as its measurements are concerned, metres.
        headings: (..., n, 2) unit vectors of the frames in which it has them.
        others: (..., n, 2) where the robots that are sensed were.
    """

    own: Real
    headings: Real
    others: Real


class OwnMotion:
    """Carries old measurements into today's frames and places, for one run or a batch of runs.

    Args:
        delay: control periods by which measurements lag.
        knows: a name of :data:`KNOWLEDGE`.
        gyro_noise: standard deviation of a turning speed, rad/s, drawn each period.
        encoder_noise: standard deviation of each coordinate of a velocity, m/s, drawn each period.
    """

    def __init__(self, delay: int, knows: str, gyro_noise: float = 0.0, encoder_noise: float = 0.0) -> None:
        if knows not in KNOWLEDGE:
            raise ValueError(f"own motion must be one of {', '.join(KNOWLEDGE)}, got {knows!r}")
        self._delay, self._knows = delay, knows
        self._gyro, self._encoder = gyro_noise, encoder_noise
        self._states: deque[tuple[Real, Real]] = deque(maxlen=delay + 1)
        self._turns: deque[Complex] = deque(maxlen=delay)
        self._steps: deque[Real] = deque(maxlen=delay)

    def begin_period(
        self, points: Real, headings: Real, period: float, generators: Sequence[np.random.Generator]
    ) -> None:
        """Take the state at the beginning of a control period, seconds; draws only what has a deviation."""
        if not self._delay:
            return
        self._states.append((points, headings))
        if self._gyro and self._knows != UNKNOWN:
            drawn = np.stack([rng.normal(0.0, self._gyro * period, points.shape[-2]) for rng in generators])
            self._turns.append(np.exp(1j * drawn.reshape(points.shape[:-1])))
        if self._encoder and self._knows == MEASURED:
            each = [rng.normal(0.0, self._encoder * period, points.shape[-2:]) for rng in generators]
            self._steps.append(np.stack(each).reshape(points.shape))

    def sense(self, points: Real, headings: Real) -> Sensed:
        """What the robots at ``points`` with ``headings`` make of measurements as old as the delay.

        Until so much time has passed, of those of the first state.
        """
        if not self._delay:
            return Sensed(points, headings, points)
        then, frames = self._states[0]
        if self._knows == UNKNOWN:
            return Sensed(then, frames, then)
        for turn in self._turns:
            headings = (headings.view(np.complex128) * turn[..., None]).view(np.float64)
        own = then if self._knows == TURN else points + sum(self._steps, np.zeros_like(points))
        return Sensed(own, headings, then)
