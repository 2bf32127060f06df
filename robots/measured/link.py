"""Commands on their way to the robots: late, and some of them lost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.drive import DifferentialDrive
from robots.measured.model import MeasuredModel

Real = NDArray[np.float64]


class Link:
    """What each robot was told last.

    Args:
        robots: (..., n).
        drive: by which the firmware turns v, omega into wheel speeds: the data sheet's.
        model: the constants.
    """

    def __init__(self, robots: tuple[int, ...], drive: DifferentialDrive, model: MeasuredModel) -> None:
        self._drive, self._model = drive, model
        self.wish = np.full((*robots, 2), np.nan)
        self._silence = np.zeros(robots)

    def send(self, wheels: Real, luck: Real, period: float) -> Real:
        """(..., n, 2) wheel speeds that the robots wish from now on, rad/s; NaN for motors that are off.

        Args:
            wheels: (..., n, 2) commanded speeds, rad/s.
            luck: (..., n) uniform draws from [0, 1): a message is lost below the share that is.
            period: seconds since the last command.
        """
        lost = luck < self._model.command_loss
        self._silence = np.where(lost, self._silence + period, 0.0)
        twist = np.abs(self._drive.twist(wheels))
        still = (twist[..., 0] < self._model.still_speed) & (twist[..., 1] < self._model.still_turn)
        told = np.where(still[..., None], np.nan, wheels)
        wish = np.where(lost[..., None], self.wish, told)
        self.wish = np.where((self._silence > self._model.time_out)[..., None], np.nan, wish)
        return self.wish
