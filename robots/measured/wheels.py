"""The wheel-speed loop of the robots' public firmware, with a motor behind it that is assumed.

Every 10 ms each wheel's speed is taken from whole encoder counts, 0.224 rad/s a count, and

    error = wish - speed,   sum = sum + error 0.01,   PWM = PWM + int(2.7 error + 0.9 sum),

cut to 255 and to steps of 50. It takes effect at the next turn of the loop. (There is a derivative gain in the
firmware, an integer initialised by 0.95, which is 0.) Between two turns the wheel follows full_speed PWM / 255 with a
first-order lag.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots.measured.model import MeasuredModel
from robots.model import ENCODER_COUNTS_PER_TURN

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_RADIANS_PER_COUNT = 2.0 * np.pi / ENCODER_COUNTS_PER_TURN


class WheelLoop:
    """The wheels of all robots.

    Args:
        shape: (..., n, 2) left and right wheels.
        model: the constants.

    Attributes:
        speed: (..., n, 2) of the wheels, rad/s.
    """

    def __init__(self, shape: tuple[int, ...], model: MeasuredModel) -> None:
        self._model = model
        self.speed = np.zeros(shape)
        self._angle, self._sum, self._pwm, self._driven = (np.zeros(shape) for _ in range(4))
        self._last_count, self._last_pwm = np.zeros(shape), np.zeros(shape)
        self._running = np.zeros(shape, dtype=bool)
        self._until_turn = 0.0  # seconds to the loop's next turn

    def advance(self, before: Real, after: Real, delay: float, period: float) -> Real:
        """Mean wheel speeds (..., n, 2), rad/s, over a control period.

        Args:
            before: (..., n, 2) wished speeds, rad/s, until ``delay`` seconds from now; NaN for motors that are off.
            after: (..., n, 2) from then on.
            delay: seconds.
            period: seconds.
        """
        begin, now = self._angle.copy(), 0.0
        while now + self._until_turn < period:
            self._roll(self._until_turn)
            now += self._until_turn
            self._turn(before if now < delay else after)
            self._until_turn = self._model.loop_period
        self._roll(period - now)
        self._until_turn -= period - now
        return (self._angle - begin) / period

    def _roll(self, seconds: float) -> None:
        target = self._driven * (self._model.full_speed / self._model.largest_pwm)
        fade = np.exp(-seconds / self._model.motor_lag)
        excess = self.speed - target
        self._angle += target * seconds + excess * (self._model.motor_lag * (1.0 - fade))
        self.speed = target + excess * fade

    def _turn(self, wish: Real) -> None:
        model, on = self._model, np.isfinite(wish)
        self._driven = np.where(on, self._pwm, 0.0)  # what the last turn decided
        count = np.floor(self._angle / _RADIANS_PER_COUNT)
        fresh = on & ~self._running
        self._last_count = np.where(fresh, count, self._last_count)
        self._sum = np.where(fresh, 0.0, self._sum)
        self._last_pwm = np.where(fresh, 0.0, self._last_pwm)
        speed = (count - self._last_count) * (_RADIANS_PER_COUNT / model.loop_period)
        error = np.where(on, wish - speed, 0.0)
        total = self._sum + error * model.loop_period
        pwm = self._pwm + np.trunc(model.proportional * error + model.integral * total)
        self._sum = np.where(np.abs(pwm) > model.largest_pwm, self._sum, total)
        pwm = np.clip(pwm, -model.largest_pwm, model.largest_pwm)
        pwm = self._last_pwm + np.clip(pwm - self._last_pwm, -model.pwm_slew, model.pwm_slew)
        self._pwm = np.where(on, pwm, self._pwm)
        self._last_pwm = np.where(on, pwm, self._last_pwm)
        self._last_count = np.where(on, count, self._last_count)
        self._running = on
