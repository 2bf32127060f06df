"""The numbers of a real robot that a log can tell, with their units and meanings, and an interval about each."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

TURN = 1.0 / 15.0
"""Seconds that the testbed's loop waits for at least in every turn: what a turn of a log is worth."""


def _number(unit: str, meaning: str) -> float:
    return field(metadata={"unit": unit, "meaning": meaning})


@dataclass(frozen=True)
class RobotNumbers:
    """One robot on the testbed. Slip is a random walk: its deviation grows with the root of the way."""

    wheel_radius: float = _number("m", "mean of both wheels")
    base_length: float = _number("m", "between the wheels, from all turning of the log")
    offset_ahead: float = _number("m", "of the tracked point, ahead of the axle's centre")
    offset_left: float = _number("m", "of the tracked point, left of the axle's centre")
    marker_angle: float = _number("rad", "of the tracked heading, beyond the direction of motion")
    lag: float = _number("turns", "by which encoder counts come later than the pose that belongs to them")
    jitter: float = _number("turns", "deviation of that lag from turn to turn")
    jitter_memory: float = _number("", "correlation of that deviation between two turns")
    position_noise: float = _number("m", "of the cameras, each coordinate")
    heading_noise: float = _number("rad", "of the cameras, beyond rounding")
    slip_along: float = _number("m/sqrt(m)", "of the position, each coordinate, over the way driven")
    slip_heading: float = _number("rad/sqrt(m)", "of the heading, over the way driven")
    slip_turning: float = _number("rad/sqrt(rad)", "of the heading, over the angle turned")
    missing: float = _number("", "share of turns in motion without new encoder counts")
    stale: float = _number("", "share of turns without a new pose")


NAMES = tuple(entry.name for entry in fields(RobotNumbers))
UNITS = {entry.name: str(entry.metadata["unit"]) for entry in fields(RobotNumbers)}
MEANINGS = {entry.name: str(entry.metadata["meaning"]) for entry in fields(RobotNumbers)}


@dataclass(frozen=True)
class Interval:
    """A number with the interval that holds the truth in 95 of 100 logs."""

    value: float
    low: float
    high: float

    def holds(self, truth: float) -> bool:
        return self.low <= truth <= self.high


QUANTILE_95 = 1.959964
"""Of the normal distribution, both sides together 5 %."""


def normal(value: float, deviation: float) -> Interval:
    """The interval of an estimate with a normal error."""
    return Interval(value, value - QUANTILE_95 * deviation, value + QUANTILE_95 * deviation)


def share(count: int, of: int) -> Interval:
    """The interval of a share, by Wilson's score (Wilson 1927)."""
    p, z2 = count / of, QUANTILE_95**2
    middle = (p + z2 / (2.0 * of)) / (1.0 + z2 / of)
    half = QUANTILE_95 * (p * (1.0 - p) / of + z2 / (4.0 * of * of)) ** 0.5 / (1.0 + z2 / of)
    return Interval(p, max(0.0, middle - half), min(1.0, middle + half))
