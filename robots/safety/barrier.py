"""The barrier: what the filter promises, on which assumptions, and with which margin.

**Point.** Robot i is protected through one point c_i, the projected point l = 0.025 m ahead of the axle. The NID gives
that point any velocity, it is the centre of the chassis, and it is the point that the testbed checks.

**Barrier.** For two robots at the distance D = |c_i - c_j|, with n the unit vector from c_j to c_i,

    h = D^2 - Ds^2,      dh/dt = 2 D n.(v_i - v_j).

A linear class-K function asks for dh/dt >= -gamma h, hence h(t) >= h(0) e^{-gamma t}: what starts safe stays safe (Ames
et al. 2019, "Control barrier functions"). Each robot answers for half of it. With the common velocity v_r of a
maneuver, which cancels between two robots that both have it,

    n.(u_i - v_r) >= -gamma h / (4 D)                                                                           (pair)

is one linear row in u_i, in the body frame of robot i, and needs nothing but the relative position of j. A wall or an
obstacle does not yield, so the robot answers for all of it; it does not move with v_r either. For a convex thing at the
distance d, with n the unit vector from its nearest point,

    n.u_i >= -gamma (d - d_min).                                                                               (thing)

**Wheels.** |u_x| + (b / 2 l) |u_y| <= r w_max: in the body frame both wheels' limits are a diamond, exactly. They are
rows as well, and the only ones that are never relaxed. While h >= 0 and v_r alone is within the wheels' limits,
u_i = v_r satisfies all rows (pair) and the wheels, so that problems without walls and obstacles are always feasible.

**Sampling.** The command is held for one period T. Since D(t + T) >= n.(c_i - c_j)(t + T), two displacements T u along
fixed directions give

    D(t + T) - Ds >= (D - Ds) (1 - gamma T (D + Ds) / (2 D)) >= (D - Ds) (1 - gamma T),

so gamma T <= 1 keeps D >= Ds without any margin (here 0.165). The same holds for (thing): a convex thing is behind the
line through its nearest point. But the robot holds its *twist*, so its point turns away from u by up to omega T during
the period and lands up to e = |u| |omega| T^2 / 2 off. Two robots lose at most 2 e a period and regain the share
gamma T of what they lack: D >= Ds - 2 e / (gamma T), see :func:`sampling_loss`.

**Bodies.** The chassis, 0.10 m x 0.11 m about c, lies within the radius :attr:`robots.model.Chassis.radius` of
0.0743 m, so D >= 0.1487 m excludes contact of corners in any orientation. Ds = 0.155 m leaves 6.3 mm for the sampling
loss, for the traction's start-up lag, and for noise; the testbed's 0.135 m lies 20 mm below.

**Not promised.** Robots pushed beyond their traction; robots that start with h < 0 (they separate, if the wheels can);
neighbours beyond the sensing range (closing from there at full speed takes longer than a period); robots with different
v_r, which drift at the difference; a point other than the centre of the chassis (with another l the circle about c no
longer contains the body); things that move; and arriving: safety comes before it, see :class:`FilterSettings`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism


@dataclass(frozen=True)
class FilterSettings:
    """What the filters can be told.

    Without more, a barrier stops two robots that meet head-on for ever, each waiting for the other. So a robot that
    drives at something near turns its law to the left first, as traffic in a roundabout does, and one that makes no
    progress although its law wants to move turns it further and further: it is *stuck*, a deadlock is declared, and the
    filter walks around it.

    Attributes:
        safe_distance: Ds, metres between two projected points.
        sensing_range: distance at which a robot is sensed, metres; walls and obstacles at as much more than
            ``clearance`` as this is more than ``safe_distance``.
        clearance: d_min, metres between a projected point and a wall or an obstacle.
        gain: gamma, 1/s.
        turn: largest turn of the law near others, radians.
        stuck_time: seconds without progress after which a deadlock is declared.

    Raises:
        ValueError: a quantity is not finite and positive (``turn``: not negative), or the range is not beyond the
            distance.
    """

    safe_distance: float = 0.155
    sensing_range: float = 0.30
    clearance: float = 0.08
    gain: float = 5.0
    turn: float = 0.7
    stuck_time: float = 2.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and (value > 0.0 or (field.name == "turn" and value == 0.0))):
                raise ValueError(f"{field.name} must be a positive number, got {value}")
        if not self.sensing_range > self.safe_distance:
            raise ValueError(
                f"sensing_range must be beyond safe_distance {self.safe_distance} m, got {self.sensing_range} m"
            )


STUCK_PROGRESS, STUCK_WISH, STUCK_RECOVERY = 0.3, 0.01, 0.4
"""The stuck time tau grows while |u - v_r| < 0.3 |s g| and |s g| > 0.01 m/s, else it shrinks at 0.4 of that rate."""

STUCK_TURN_RATE, STUCK_TURN_LIMIT = 0.5, 1.5
"""rad/s and rad: how fast and how far the law of a stuck robot turns further."""

WHEEL_MARGIN = 1e-6
"""Share of the wheels' limit left free, so that rounding never shows as a command beyond it."""


def stuck_limit(settings: FilterSettings) -> float:
    """Seconds: the stuck time at which a robot has turned all the way, and tries the other side."""
    return settings.stuck_time + STUCK_TURN_LIMIT / STUCK_TURN_RATE


SENSED_BEYOND = 0.15
"""Metres by which a robot has to be sensed before its row binds, as with the defaults."""

DELAY_GAIN = 0.5
"""gamma tau under a delay tau. Two robots that sense each other late obey dy/dt = -(gamma / 2) (y(t) + y(t - tau)), y
the sensed distance beyond Ds: it decays without overshoot, and the true distance stays ahead of Ds."""


def delayed_settings(settings: FilterSettings, delay: float, speed: float) -> FilterSettings:
    """The settings that keep the barrier's promise where others are sensed ``delay`` seconds late.

    With its own motion undone a robot errs by the others' motion alone, at most ``speed`` times ``delay`` metres each.
    Two robots answer for half of the barrier each, so each adds half of that to Ds; the sensing range keeps its
    distance beyond Ds, and gamma shrinks to :data:`DELAY_GAIN` over the delay where it is larger.
    """
    if delay == 0.0:
        return settings
    distance = settings.safe_distance + speed * delay / 2.0
    reach = max(settings.sensing_range, distance + SENSED_BEYOND)
    gain = min(settings.gain, DELAY_GAIN / delay)
    return replace(settings, safe_distance=distance, sensing_range=reach, gain=gain)


def turn_weight(drive: DifferentialDrive, nid: NearIdentityDiffeomorphism) -> float | NDArray[np.float64]:
    """b / 2 l, the weight of u_y in the wheels' limit |u_x| + (b / 2 l) |u_y| <= r w_max."""
    return drive.base_length / (2.0 * nid.projection_distance)


def sampling_loss(
    drive: DifferentialDrive, nid: NearIdentityDiffeomorphism, settings: FilterSettings, period: float
) -> float:
    """Metres by which two robots may come closer than Ds because each holds its twist for a period, seconds.

    The largest |u| |omega| over the wheels' diamond, twice for two robots, over gamma T.
    """
    limit, ahead = drive.speed_limit, nid.projection_distance
    omega = np.linspace(0.0, drive.turn_limit, 1001)
    speed = np.hypot(limit - omega * drive.base_length / 2.0, ahead * omega)
    return float(2.0 * (speed * omega).max() * period**2 / 2.0 / (settings.gain * period))
