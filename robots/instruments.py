"""What the robots of one experiment carry: the kinds of measurements that its law declares, each with its noise.

Everything is derived from the relative positions of projected points in body frames. What nobody declared is not
computed, so no law can use it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots.sensors import Real, RelativePositionSensor, disturb

KINDS = ("relative position", "bearing", "distance", "angle", "ratio")
"""Kinds of measurements by name; :class:`Instruments` says what each is."""


@dataclass(frozen=True)
class Imperfections:
    """Standard deviations of noise that is drawn each control period, and how often nothing is measured.

    Attributes:
        position: of each coordinate of a relative position, metres.
        bearing: of the direction of a relative position or of a bearing, radians.
        distance: of a distance, metres.
        angle: of an angle between two neighbours, radians.
        ratio: of a ratio of distances, as a fraction of it.
        edge_loss: probability that an edge gives nothing during a control period.
        dropout: probability that a robot measures nothing during a control period.
    """

    position: float = 0.0
    bearing: float = 0.0
    distance: float = 0.0
    angle: float = 0.0
    ratio: float = 0.0
    edge_loss: float = 0.0
    dropout: float = 0.0


@dataclass(frozen=True, eq=False)
class Disturbance:
    """One control period's draws, for one run or, batches leading, for several; None for what is perfect.

    Attributes:
        relative: unit rotations (..., m, 2) and offsets (..., m, 2), metres.
        distance: (..., m) metres.
        angle: (..., c) radians.
        ratio: (..., c) factors.
        lost: (..., m) which edges give nothing.
        keys: (...) that ``relative`` follows from; see :class:`robots.senses.noise.Noise`.
    """

    relative: tuple[Real, Real] | None = None
    distance: Real | None = None
    angle: Real | None = None
    ratio: Real | None = None
    lost: NDArray[np.bool_] | None = None
    keys: NDArray[np.uint64] | None = None

    @classmethod
    def stack(cls, draws: Sequence[Disturbance], batch: tuple[int, ...]) -> Disturbance:
        """The draws of several runs as one, or that of a single run where ``batch`` is ()."""

        def together(parts: list[NDArray[Any]]) -> NDArray[Any]:
            return np.stack(parts).reshape((*batch, *parts[0].shape))

        first = draws[0]
        relative = None
        if first.relative is not None:
            pairs = [draw.relative for draw in draws if draw.relative is not None]
            relative = together([turn for turn, _ in pairs]), together([offset for _, offset in pairs])
        rest: dict[str, Any] = {
            name: None if getattr(first, name) is None else together([getattr(draw, name) for draw in draws])
            for name in ("distance", "angle", "ratio", "lost", "keys")
        }
        return cls(relative, **rest)


class Instruments:
    """The sensors of all robots at once.

    | kind | array | what it is |
    |---|---|---|
    | ``relative position`` | (..., m, 2) | of the observed projected point, metres, in the observer's body frame |
    | ``bearing`` | (..., m, 2) | its direction, a unit vector |
    | ``distance`` | (..., m) | its length, metres |
    | ``angle`` | (..., c) | counter-clockwise from a corner's first edge to its second, radians in [0, 2 pi) |
    | ``ratio`` | (..., c) | length of a corner's second edge over that of its first: apparent size of equal robots |

    A lost edge gives NaN in all that it takes part in.

    Attributes:
        edges: (m, 2) as given.
        imperfections: of the sensors.

    Args:
        edges: (m, 2) rows (observer, observed).
        corners: (c, 2) rows of ``edges`` that share an observer.
        kinds: names of :data:`KINDS`, in the order in which they are delivered.
        imperfections: of the sensors.

    Raises:
        ValueError: an unknown kind.
    """

    def __init__(
        self,
        edges: ArrayLike,
        corners: ArrayLike = (),
        kinds: Sequence[str] = KINDS[:1],
        imperfections: Imperfections | None = None,
    ) -> None:
        if unknown := [kind for kind in kinds if kind not in KINDS]:
            raise ValueError(f"measures must be among {', '.join(KINDS)}, got {unknown[0]!r}")
        self.edges = np.asarray(edges, dtype=np.intp)
        self._first, self._second = np.asarray(corners, dtype=np.intp).reshape(-1, 2).T
        self._corners, self._kinds = corners, tuple(kinds)
        self.imperfections = imperfections or Imperfections()
        self._places = RelativePositionSensor(self.edges, self.imperfections.position, self.imperfections.bearing)

    def having(self, imperfections: Imperfections) -> Instruments:
        """The same instruments with other imperfections."""
        return Instruments(self.edges, self._corners, self._kinds, imperfections)

    def measure(self, points: Real, headings: Real, own: Real | None = None) -> Real:
        """(..., m, 2) true relative positions in body frames; see :class:`robots.sensors.RelativePositionSensor`."""
        return self._places.measure(points, headings, own)

    def draw(self, rng: np.random.Generator) -> Disturbance | None:
        """One period's disturbance of one run; None where all is perfect, and then nothing is drawn.

        The order is fixed: rotations and offsets, distances, angles, ratios, lost edges, robots that drop out; each
        for all edges, or corners, in their order, and only if its own deviation or probability is not 0.
        """
        has = self.imperfections
        if has == Imperfections():
            return None
        m, c = len(self.edges), len(self._first)
        key = self._places.key(rng)
        relative = None if key is None else self._places.noise(key)
        distance = rng.normal(0.0, has.distance, m) if has.distance else None
        angle = rng.normal(0.0, has.angle, c) if has.angle else None
        ratio = 1.0 + rng.normal(0.0, has.ratio, c) if has.ratio else None
        lost = None
        if has.edge_loss or has.dropout:
            lost = rng.random(m) < has.edge_loss if has.edge_loss else np.zeros(m, dtype=bool)
            if has.dropout:
                observer = self.edges[:, 0]
                blind = rng.random(int(observer.max(initial=-1)) + 1) < has.dropout
                lost = lost | blind[observer]
        return Disturbance(relative, distance, angle, ratio, lost, None if key is None else np.array(key))

    def deliver(self, relative: Real, disturbance: Disturbance | None) -> tuple[Real, ...]:
        """One array for each kind, from true relative positions (..., m, 2) and one period's disturbance."""
        if disturbance is None and self._kinds == KINDS[:1]:
            return (relative,)
        noise = disturbance or Disturbance()
        return tuple(self._without(kind, self._one(kind, relative, noise), noise.lost) for kind in self._kinds)

    def _without(self, kind: str, measured: Real, lost: NDArray[np.bool_] | None) -> Real:
        """The measurements (..., rows) or (..., rows, 2) of a kind, NaN where an edge that they need is lost."""
        if lost is None:
            return measured
        gone = lost[..., self._first] | lost[..., self._second] if kind in ("angle", "ratio") else lost
        return np.where(gone[..., None] if kind in KINDS[:2] else gone, np.nan, measured)

    def _one(self, kind: str, relative: Real, noise: Disturbance) -> Real:
        if kind == "relative position":
            return disturb(relative, noise.relative)
        e = relative.view(np.complex128)[..., 0]
        if kind == "bearing":
            b = e / np.abs(e)
            turned = b if noise.relative is None else b * noise.relative[0].view(np.complex128)[..., 0]
            return turned[..., None].view(np.float64)
        if kind == "distance":
            return np.abs(e) if noise.distance is None else np.abs(e) + noise.distance
        first, second = e[..., self._first], e[..., self._second]
        if kind == "angle":
            angle = np.angle(second * np.conj(first))
            return np.mod(angle if noise.angle is None else angle + noise.angle, 2.0 * np.pi)
        ratio = np.abs(second) / np.abs(first)
        return ratio if noise.ratio is None else ratio * noise.ratio
