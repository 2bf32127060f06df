"""The robot file: an identified robot's numbers, with units in the names and intervals beside, in TOML."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from robots.identification.numbers import NAMES, UNITS, Interval, RobotNumbers
from robots.measured import MEASURED, MeasuredModel
from robots.worlds import MEASURED_PLANTS
from scenarios.definition.schema import Scenario
from scenarios.errors import InputError, did_you_mean

KEYS = {name: name + {"": "", "m": "_m", "rad": "_rad", "turns": "_turns"}.get(UNITS[name], "") for name in NAMES}
"""The file's key of each number. Slips are per root of metre or radian, as their names' first words are."""

_POSITIVE = ("wheel_radius", "base_length")
_SHARES = ("missing", "stale", "jitter_memory")
_SIGNED = ("offset_ahead", "offset_left", "marker_angle", "lag")
_LARGEST = {"wheel_radius": 0.1, "base_length": 1.0, "lag": 100.0}


def put_in(scenario: Scenario, path: str, folder: Path) -> Scenario:
    """The scenario with the numbers of its robot file in the file's place, so that it needs nothing outside it.

    Args:
        scenario: as validated.
        path: of the scenario, for messages.
        folder: of the scenario; a file that is not there is looked for where the command runs.

    Raises:
        InputError: the file or the numbers cannot be used.
    """
    table = scenario.robot
    if table.file is None:
        return scenario
    if table.model == "nominal":
        raise InputError(f'{path}: robot.file: only for robot.model = "measured", got "nominal"')
    here = folder / table.file
    found = here if here.exists() else Path(table.file)
    numbers = {KEYS[name]: value for name, value in asdict(read(found, f"{path}: robot.file {table.file}")).items()}
    return scenario.model_copy(update={"robot": table.model_copy(update={"file": None, "numbers": numbers})})


def measured(scenario: Scenario, path: str) -> MeasuredModel | None:
    """The measured robots of a scenario; None for nominal ones.

    Raises:
        InputError: the plant has no robots that could be measured, or a number is missing, unknown or impossible.
    """
    table = scenario.robot
    if table.model == "nominal":
        if table.numbers:
            raise InputError(f'{path}: robot.numbers: only for robot.model = "measured", got "nominal"')
        return None
    if scenario.plant.name not in MEASURED_PLANTS:
        raise InputError(
            f'{path}: robot.model: "measured" robots move on the plants {" and ".join(MEASURED_PLANTS)}, '
            f"got {scenario.plant.name}"
        )
    numbers = checked(table.numbers, f"{path}: robot.numbers") if table.numbers else MEASURED.numbers
    return replace(MEASURED, numbers=numbers, base_spread=table.base_spread, radius_spread=table.radius_spread)


def text(intervals: Mapping[str, Interval], comment: str) -> str:
    """The content of a robot file; ``comment`` says where the numbers come from."""
    lines = [*(f"# {line}".rstrip() for line in comment.splitlines()), ""]
    lines += [f"{KEYS[name]} = {interval.value:.6g}" for name, interval in intervals.items()]
    lines += ["", "[interval_95]"]
    lines += [f"{KEYS[name]} = [{i.low:.6g}, {i.high:.6g}]" for name, i in intervals.items()]
    return "\n".join(lines) + "\n"


def read(path: Path, named: str) -> RobotNumbers:
    """The numbers of a robot file.

    Args:
        path: the file.
        named: what a message calls it.

    Raises:
        InputError: no such file, not TOML, a number that is missing, unknown or impossible.
    """
    try:
        content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(f"{named}: no such robot file") from error
    except OSError as error:
        raise InputError(f"{named}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{named}: not valid TOML: {error}") from error
    content.pop("interval_95", None)
    return checked(content, named)


def checked(content: Mapping[str, object], named: str) -> RobotNumbers:
    """Numbers by their keys in a file.

    Raises:
        InputError: a number is missing, unknown or impossible.
    """
    names = {key: name for name, key in KEYS.items()}
    for key in content:
        if key not in names:
            raise InputError(f"{named}: {key}: unknown key, {did_you_mean(key, names)}")
    for key in names:
        if key not in content:
            raise InputError(f"{named}: {key}: missing")
    return RobotNumbers(**{name: _possible(named, key, name, content[key]) for key, name in names.items()})


def _possible(named: str, key: str, name: str, value: object) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise InputError(f"{named}: {key}: expected a number, got {value!r}")
    number, largest = float(value), _LARGEST.get(name, 1.0)
    low = -largest if name in _SIGNED else 0.0
    if not low <= number <= largest or (name in _POSITIVE and number == 0.0) or (name in _SHARES and number >= 1.0):
        raise InputError(f"{named}: {key}: expected a number from {low:g} to {largest:g}, got {value!r}")
    return number
