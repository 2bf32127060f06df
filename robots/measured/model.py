"""The measured robot: every constant with its unit, its source and, where it is assumed, the range it may lie in.

Sources: *log*, a public log of a GTernal on the Robotarium (N8BWert/robotarium-slam, trial 15), as `formation identify`
reads it; *firmware*, the robots' public firmware (robotarium/GTernal, firmware/Teensy/libraries/GTernal and
firmware/RPi); *data sheet*, the public simulators; *assumed*, nobody has measured it in public.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from robots.identification.numbers import RobotNumbers

IDENTIFIED = RobotNumbers(
    wheel_radius=0.0160,
    base_length=0.1055,
    offset_ahead=0.0008,
    offset_left=0.0,
    marker_angle=0.0053,
    lag=0.72,
    jitter=0.352,
    jitter_memory=0.47,
    position_noise=5.2e-5,
    heading_noise=4.9e-4,
    slip_along=2.6e-3,
    slip_heading=8.6e-3,
    slip_turning=1.72e-2,
    missing=0.19,
    stale=0.0048,
)
"""The robot of the log; `docs/testbed.md` has the intervals."""


def _constant(default: float, unit: str, source: str, meaning: str, span: str = "") -> float:
    metadata = {"unit": unit, "source": source, "meaning": meaning, "range": span}
    return field(default=default, metadata=metadata)


@dataclass(frozen=True)
class MeasuredModel:
    """What stands between command and motion, and between motion and what the cameras say.

    Attributes:
        numbers: of the robot, as identified.
    """

    numbers: RobotNumbers = IDENTIFIED
    base_spread: float = _constant(
        0.01, "", "assumed", "relative deviation of base lengths from robot to robot", "0-0.02"
    )
    radius_spread: float = _constant(0.005, "", "assumed", "relative deviation of wheel radii", "0-0.01")
    loop_period: float = _constant(0.01, "s", "firmware", "between two turns of the wheel-speed loop (_PIDTimeStep)")
    proportional: float = _constant(
        2.7, "PWM s/rad", "firmware", "gain on the speed's error, added each turn (_kpMotor)"
    )
    integral: float = _constant(0.9, "PWM/rad", "firmware", "gain on the error's integral, likewise (_kiMotor)")
    largest_pwm: float = _constant(255.0, "PWM", "firmware", "the driver's full scale")
    pwm_slew: float = _constant(50.0, "PWM", "firmware", "largest change a turn (_maxMotorInc)")
    still_speed: float = _constant(
        1e-4, "m/s", "firmware", "below this and the next the motors are off (followCommands)"
    )
    still_turn: float = _constant(0.01, "rad/s", "firmware", "likewise")
    time_out: float = _constant(
        0.5, "s", "firmware", "without a message, after which the motors stop (defaultOperation)"
    )
    command_delay: float = _constant(
        0.018, "s", "assumed", "from command to motors: half the 0.016 s of pi_firmware, and network", "0.008-0.03"
    )
    command_loss: float = _constant(
        0.19, "", "assumed", "share of commands lost, as the log's share of encoder messages", "0-0.19"
    )
    full_speed: float = _constant(20.0, "rad/s", "assumed", "of a wheel at full PWM", "14-33")
    motor_lag: float = _constant(0.05, "s", "assumed", "first-order lag of motor and gear", "0.02-0.1")
    camera_latency: float = _constant(
        0.033, "s", "assumed", "from motion to pose; the log tells the encoders' lag alone", "0.01-0.08"
    )


MEASURED = MeasuredModel()
"""The measured robot with the spread that is assumed of others."""
