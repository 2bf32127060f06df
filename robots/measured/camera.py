"""What the overhead cameras say: late by a time that jitters, now and then nothing new, a little beside, rounded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.identification.numbers import TURN
from robots.measured.model import MeasuredModel

Real = NDArray[np.float64]

KEPT = 6
"""Poses in memory: the oldest that a camera may still show."""

_QUANTUM = 0.001  # rad, log: headings in whole milliradians
_DRAWS = 4


class Camera:
    """The poses of all robots as the cameras give them, once per control period.

    Args:
        poses: (..., n, 3) where the robots stand.
        model: the constants.
    """

    def __init__(self, poses: Real, model: MeasuredModel) -> None:
        self._model = model
        self._kept = [poses.copy() for _ in range(KEPT)]  # newest first
        self._jitter = np.zeros(poses.shape[:-1])
        self.seen = self._tracked(poses)

    def take(self, poses: Real, normal: Real, luck: Real, period: float) -> None:
        """See the robots after a period.

        Args:
            poses: (..., n, 3) where they are.
            normal: (..., n, 4) standard normal draws: noise of x, y, theta, jitter.
            luck: (..., n) uniform draws from [0, 1): the cameras have nothing new below the share of stale poses.
            period: seconds.
        """
        numbers = self._model.numbers
        self._kept = [poses.copy(), *self._kept[:-1]]
        memory = numbers.jitter_memory ** (period / TURN)
        self._jitter = memory * self._jitter + np.sqrt(1.0 - memory**2) * numbers.jitter * TURN * normal[..., 3]
        age = np.clip((self._model.camera_latency + self._jitter) / period, 0.0, KEPT - 1.001)
        whole = age.astype(np.intp)
        share = (age - whole)[..., None]
        kept = np.stack(self._kept)
        newer = np.take_along_axis(kept, whole[None, ..., None], axis=0)[0]
        older = np.take_along_axis(kept, whole[None, ..., None] + 1, axis=0)[0]
        seen = self._tracked(newer + share * (older - newer))
        seen[..., :2] += numbers.position_noise * normal[..., :2]
        heading = seen[..., 2] + numbers.heading_noise * normal[..., 2]
        seen[..., 2] = _QUANTUM * np.rint(heading / _QUANTUM)
        self.seen = np.where((luck < numbers.stale)[..., None], self.seen, seen)

    def _tracked(self, poses: Real) -> Real:
        """Poses of the tracked points, of poses of the axles' centres."""
        numbers = self._model.numbers
        ahead, left = numbers.offset_ahead, numbers.offset_left
        cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        return np.stack(
            [
                poses[..., 0] + ahead * cos - left * sin,
                poses[..., 1] + ahead * sin + left * cos,
                poses[..., 2] + numbers.marker_angle,
            ],
            axis=-1,
        )
