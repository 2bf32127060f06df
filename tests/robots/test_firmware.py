"""The wheel loop is the firmware's: every ten milliseconds whole counts, whole steps, cut and slewed."""

import numpy as np
import pytest

from robots.measured import MEASURED
from robots.measured.wheels import WheelLoop

COUNT = 2.0 * np.pi / 2800.0


def firmware(wishes: list[float], period: float) -> list[float]:
    """Mean speeds, rad/s, of one wheel: the loop as the firmware writes it, the motor in fine steps."""
    angle = speed = total = pwm = driven = last_pwm = 0.0
    last, running, found, clock, turn = 0.0, False, [], 0.0, 0.0
    fine = 1e-4
    for index, wish in enumerate(wishes):
        begin = angle
        while clock < (index + 1) * period - fine / 2.0:
            if clock >= turn - fine / 2.0:
                turn += 0.01
                on = np.isfinite(wish)
                driven = pwm if on else 0.0
                count = np.floor(angle / COUNT + 1e-12)
                if on and not running:
                    last, total, last_pwm = count, 0.0, 0.0
                if on:
                    error = wish - (count - last) * COUNT / 0.01
                    summed = total + error * 0.01
                    new = pwm + np.trunc(2.7 * error + 0.9 * summed)
                    total = summed if abs(new) <= 255.0 else total
                    new = min(max(new, -255.0), 255.0)
                    pwm = last_pwm + min(max(new - last_pwm, -50.0), 50.0)
                    last_pwm, last = pwm, count
                running = bool(on)
            target = driven * 20.0 / 255.0
            angle += target * fine + (speed - target) * 0.05 * (1.0 - np.exp(-fine / 0.05))
            speed = target + (speed - target) * np.exp(-fine / 0.05)
            clock += fine
        found.append((angle - begin) / period)
    return found


@pytest.mark.parametrize(
    "wishes", [[3.0] * 30, [12.0] * 10 + [-12.0] * 20, [0.4] * 30, [5.0] * 10 + [np.nan] * 10 + [5.0] * 10, [40.0] * 30]
)
def test_a_wheel_does_what_the_firmware_does_turn_by_turn(wishes: list[float]) -> None:
    loop, period = WheelLoop((1, 2), MEASURED), 0.0333
    found = [loop.advance(np.full((1, 2), wish), np.full((1, 2), wish), 0.0, period)[0, 0] for wish in wishes]
    np.testing.assert_allclose(found, firmware(wishes, period), atol=0.25)  # one count, seen a turn earlier or later
    assert np.mean(np.abs(np.subtract(found, firmware(wishes, period)))) < 0.05


def test_a_wish_that_comes_late_counts_from_the_turns_after_its_delay_on() -> None:
    early, late = (WheelLoop((1, 2), MEASURED) for _ in range(2))
    fast, slow = np.full((1, 2), 10.0), np.full((1, 2), 2.0)
    for _ in range(60):
        early.advance(slow, slow, 0.0, 0.033)
        late.advance(slow, slow, 0.0, 0.033)
    early.advance(slow, fast, 0.0, 0.033)
    late.advance(slow, fast, 0.025, 0.033)
    assert early.advance(fast, fast, 0.0, 0.033).mean() > late.advance(fast, fast, 0.0, 0.033).mean() + 0.3
