"""A log of a real robot: its numbers with intervals, as a table and as a robot file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape

from robots.identification.check import checked
from robots.identification.estimate import Identified, identify
from robots.identification.log import Log, LogError
from robots.identification.numbers import MEANINGS, NAMES, UNITS, Interval, RobotNumbers
from robots.identification.odometry import RADIANS_PER_COUNT
from robots.identification.reading import read_arrays
from robots.identification.reckoning import WINDOW, Reckoning, dead_reckoning
from robots.identification.synthetic import synthesise, way_of
from robots.model import GTERNAL
from scenarios.definition.files import robot_file
from scenarios.documents import markdown_table
from scenarios.errors import InputError
from scenarios.terminal import new_table, print_table

DATA_SHEET = RobotNumbers(
    **dict.fromkeys(NAMES, 0.0) | {"wheel_radius": GTERNAL.drive.wheel_radius, "base_length": GTERNAL.drive.base_length}
)
"""The robot of the public simulators: its data sheet's wheels, and nothing that a log knows."""


def open_log(path: Path, robot: int = 1) -> Log:
    """One robot's log from a file.

    Raises:
        InputError: it cannot be read, or does not hold one robot's poses and counts.
    """
    try:
        return checked(*read_arrays(path, robot))
    except LogError as error:
        raise InputError(f"{path}: {error}") from error


def identified(path: Path, robot: int = 1) -> Identified:
    """The numbers of the robot that a log is of.

    Raises:
        InputError: as :func:`open_log`, or the robot hardly moves.
    """
    log = open_log(path, robot)
    try:
        return identify(log)
    except LogError as error:
        raise InputError(f"{path}: {error}") from error


def reckonings(found: Identified) -> list[tuple[str, Reckoning, Reckoning]]:
    """Dead reckoning over :data:`robots.identification.reckoning.WINDOW` turns: whose, by data sheet, as identified.

    Beside the log stand two simulated robots that go its wheels' way: one of the identified numbers with all its
    noises, and the data sheet's, whose poses and counts are exact but for rounding.
    """
    numbers = found.numbers
    simulated = []
    for robot in (numbers, DATA_SHEET):
        rng = np.random.default_rng(0)
        simulated.append(checked(*synthesise(way_of(found.log, robot), robot, rng)))
    names, lags = ("the log", "simulated, measured", "simulated, data sheet"), (numbers.lag, numbers.lag, 0.0)
    return [
        (name, by_data_sheet(log, lag), by_numbers(log, replace(numbers, lag=lag)))
        for name, log, lag in zip(names, (found.log, *simulated), lags, strict=True)
    ]


def by_data_sheet(log: Log, lag: float) -> Reckoning:
    """Errors by the data sheet, the last counts standing where a message was lost."""
    drive = GTERNAL.drive
    return dead_reckoning(log, drive.wheel_radius, drive.base_length, float(round(lag)), spread=False)


def by_numbers(log: Log, numbers: RobotNumbers) -> Reckoning:
    """Errors by identified numbers, lost counts spread."""
    offset = complex(numbers.offset_ahead, numbers.offset_left)
    return dead_reckoning(log, numbers.wheel_radius, numbers.base_length, numbers.lag, offset, numbers.marker_angle)


def rows(found: Identified) -> list[tuple[str, str, str, str, str]]:
    """Name, value, interval, unit and meaning of every number, the two that explain the base length last."""
    explained = (
        ("base_length_short", found.short_base_length, "m", "the same within a few turns, the drift taken out"),
        ("heading_drift", found.drift, "rad/m", "to the left over the way forward, as of unequal wheels"),
    )
    table = [(name, interval, UNITS[name], MEANINGS[name]) for name, interval in found.intervals.items()]
    return [(name, *_figures(interval), unit, meaning) for name, interval, unit, meaning in (*table, *explained)]


def quantisation(found: Identified) -> str:
    """A sentence on the steps in which cameras and encoders speak."""
    step = RADIANS_PER_COUNT * found.numbers.wheel_radius
    heading = found.log.heading_quantum
    cameras = f"headings {1e3 * heading:g} mrad" if heading else "headings none"
    return f"{cameras}, encoders 1 count or {1e6 * step:.0f} um of the wheel's way"


def print_identified(console: Console, found: Identified) -> None:
    """The numbers, what was repaired, and dead reckoning, for a person."""
    table = new_table("quantity", "value", "95 % interval", "unit", title=f"{found.log.turns} turns")
    for name, value, interval, unit, _ in rows(found):
        table.add_row(name, value, interval, unit)
    print_table(console, table)
    console.print(f"quantisation: {quantisation(found)}")
    for repair in found.log.repairs:
        console.print(f"repaired: {escape(repair)}")
    title = f"dead reckoning over {WINDOW} turns, rms of position and heading"
    table = new_table("quantity", "by the data sheet", "as identified", title=title)
    for name, nominal, true in reckonings(found):
        table.add_row(name, _errors(nominal), _errors(true))
    print_table(console, table)


def markdown(found: Identified) -> list[str]:
    """The same tables, for a page."""
    reckoned = [[name, _errors(nominal), _errors(true)] for name, nominal, true in reckonings(found)]
    return [
        *markdown_table(("quantity", "value", "95 % interval", "unit", "meaning"), rows(found)),
        "",
        f"Quantisation: {quantisation(found)}.",
        "",
        f"Dead reckoning over {WINDOW} turns, a window at every turn, root mean square:",
        "",
        *markdown_table(("whose poses and counts", "by the data sheet", "as identified"), reckoned, numbers=2),
    ]


def robot_file_text(found: Identified, source: str) -> str:
    """The robot file, for ``robot.file`` of a scenario."""
    return robot_file.text(
        found.intervals, f"A robot as `formation identify {source}` found it, {found.log.turns} turns."
    )


def _errors(reckoning: Reckoning) -> str:
    return f"{1e3 * reckoning.position:.1f} mm, {reckoning.heading:.4f} rad"


def _figures(interval: Interval) -> tuple[str, str]:
    """The value and its interval, to two digits of the interval's width."""
    from math import floor, log10

    width = interval.high - interval.low
    digits = max(0, 1 - floor(log10(width))) if width > 0.0 else 6
    return f"{interval.value:.{digits}f}", f"{interval.low:.{digits}f} to {interval.high:.{digits}f}"
