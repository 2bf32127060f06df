"""From a scenario's name or path, and ``--set`` changes, to a validated :class:`Scenario`."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from scenarios.definition.bounds import LARGEST_INTEGER
from scenarios.definition.digest import digest
from scenarios.definition.files import law_file
from scenarios.definition.files.law_file import LawFile
from scenarios.definition.files.library import LIBRARY as LIBRARY
from scenarios.definition.files.library import library as library
from scenarios.definition.files.reading import read_regular
from scenarios.definition.files.way_points import with_file
from scenarios.definition.schema import LawTable, Scenario
from scenarios.errors import InputError, did_you_mean, plain

LONGEST_VALUE = 80
"""Characters of a refused value that a message repeats."""


@dataclass(frozen=True)
class ScenarioFile:
    """A scenario with where it came from.

    Attributes:
        name: the file's stem.
        path: as given, for messages.
        description: the comment at the file's head, without its hash signs.
        scenario: the validated content, changes included.
        law: the file of an own law; None for the others.
    """

    name: str
    path: str
    description: str
    scenario: Scenario
    law: LawFile | None = None

    @property
    def sha256(self) -> str:
        """Digest of the validated content: equal for files that mean the same, different after any change.

        Of an own law its source counts, wherever its file is.
        """
        return digest(self.scenario.model_dump(mode="json"), self.law)


def find(scenario: str) -> Path:
    """The file of a library name, or the path itself where it is one.

    Raises:
        InputError: the library has no such name.
    """
    if scenario.endswith(".toml") or "/" in scenario:
        return Path(scenario)
    if scenario not in library():
        near = did_you_mean(scenario, library(), "formation list shows the known ones")
        raise InputError(f"scenario: no scenario named {scenario!r}, {near}")
    return LIBRARY / f"{scenario}.toml"


def load(scenario: str, changes: Sequence[str] = ()) -> ScenarioFile:
    """Read and validate a scenario by name or path.

    Args:
        scenario: a library name, or a path to a TOML file.
        changes: ``key=value`` texts; dotted keys, values as in TOML, ``agents.3.start=[0, 1]`` by agent number.

    Raises:
        InputError: no such file, not TOML, content that the schema refuses, or no such law file.
    """
    path = find(scenario)
    if not path.name.isprintable():
        raise InputError(f"{scenario}: expected a file name that can be printed")
    try:
        text = read_regular(path).decode("utf-8-sig")  # some editors begin a file with a byte-order mark
    except FileNotFoundError as error:
        others = sorted(each.name for each in path.parent.glob("*.toml"))
        hint = did_you_mean(path.name, others, "formation list shows the library's")
        raise InputError(f"{scenario}: no such scenario file, {hint}") from error
    except IsADirectoryError as error:
        raise InputError(f"{scenario}: a folder, expected a scenario's name or file") from error
    except OSError as error:
        raise InputError(f"{scenario}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{scenario}: not a text file in UTF-8: {error.reason} at byte {error.start}") from error
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # besides TOMLDecodeError: numbers too long, nesting too deep
        raise InputError(f"{scenario}: not valid TOML: {error}") from error
    validated = validate(with_file(with_changes(data, changes), scenario, path.parent), scenario)
    if validated.robot.file is not None:
        from scenarios.definition.files import robot_file  # robots bring numpy, which few commands that load need

        validated = robot_file.put_in(validated, scenario, path.parent)
    law = None if validated.law.file is None else law_file.read(scenario, path.parent, validated.law.file)
    return ScenarioFile(path.stem, scenario, head_comment(text), validated, law)


def changed(changes: tuple[str, ...], plant: str | None = None, safety: str | None = None) -> tuple[str, ...]:
    """The changes of a scenario, with those that ``--plant`` and ``--safety`` stand for."""
    meant = {"plant.name": plant, "safety.filter": safety}
    return (*changes, *(f'{key}="{value}"' for key, value in meant.items() if value is not None))


def with_changes(data: dict[str, Any], changes: Sequence[str]) -> dict[str, Any]:
    """The same parsed scenario, changed by ``key=value`` texts as :func:`load` takes them.

    Raises:
        InputError: a text has no key or no place.
    """
    for change in changes:
        _apply(data, change)
    return data


def head_comment(text: str) -> str:
    """The comment block at the head of a scenario file, without its hash signs.

    >>> head_comment("# Six robots.\\n#\\n# Law  (u)\\n\\ntitle = 1")
    'Six robots.\\n\\nLaw  (u)'
    """
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(plain(line.removeprefix("#").removeprefix(" ").replace("\t", " ")))
    return "\n".join(lines)


def validate(data: Mapping[str, Any], file: str) -> Scenario:
    """The scenario in parsed TOML ``data``.

    Raises:
        InputError: the first thing that the schema refuses.
    """
    _check_integers(data, file)
    try:
        scenario = Scenario.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{file}: {_explain(error, data)}") from None
    seen: set[int] = set()
    for agent in scenario.agents:
        if agent.id in seen:
            raise InputError(f"{file}: agents: agent {agent.id} is listed twice")
        seen.add(agent.id)
    for number in range(1, len(seen) + 1):
        if number not in seen and scenario.graph == "given":
            raise InputError(f"{file}: agents: agent {number} is missing, agents are numbered 1 to {len(seen)}")
    if (scenario.random_formation is None) == (not scenario.agents):
        raise InputError(f"{file}: agents: expected either agents or random_formation")
    if scenario.agents and len(scenario.agents) < 3:
        raise InputError(f"{file}: agents: expected at least 3, got {len(scenario.agents)}")
    if bool(scenario.phases) == (scenario.duration_s is not None):
        both = "both" if scenario.phases else "neither"
        raise InputError(f"{file}: duration_s: expected either duration_s or phases, got {both}")
    if scenario.reference is not None and scenario.phases:
        raise InputError(f"{file}: reference: expected either reference or phases, got both")
    _check_own_law(scenario.law, file)
    return scenario


def _check_integers(data: Mapping[str, Any], file: str) -> None:
    """An integer in a scenario has 64 bits, as TOML has it; a longer one cannot even be printed."""
    waiting: list[tuple[tuple[int | str, ...], Any]] = [((), data)]  # no recursion: a list of lists may be deep
    while waiting:
        location, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [((*location, key), entry) for key, entry in value.items()]
        elif isinstance(value, list):
            waiting += [((*location, index), entry) for index, entry in enumerate(value)]
        elif isinstance(value, int) and not -LARGEST_INTEGER <= value <= LARGEST_INTEGER:
            raise InputError(
                f"{file}: {_field_name(location, data)}: expected an integer of at most 64 bits, "
                f"got one of {value.bit_length()}"
            )


def _check_own_law(law: LawTable, file: str) -> None:
    """An own law has a file and a factory and decides for agent 2; the others have none of its keys."""
    none = LawTable()
    if law.name != "own":
        for key in ("file", "factory"):
            if getattr(law, key) != getattr(none, key):
                raise InputError(f'{file}: law.{key}: only for law.name = "own", got "{law.name}"')
        return
    for key in ("file", "factory"):
        if not getattr(law, key):
            raise InputError(f'{file}: law.{key}: missing, the law "own" needs it')
    if law.first_follower != none.first_follower:
        raise InputError(f"{file}: law.first_follower: an own law says itself what agent 2 does, expected none")


def _apply(data: dict[str, Any], change: str) -> None:
    key, equals, text = change.partition("=")
    parts = key.strip().split(".")
    if not equals or not all(parts):
        raise InputError(f"--set {_shortened(change)}: expected key=value with a dotted key")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text.strip()  # a bare word, as in plant.name=saturated
    except (ValueError, RecursionError) as error:
        raise InputError(f"--set {_shortened(change)}: not a TOML value: {error}") from error
    place: Any = data
    for part in parts[:-1]:
        place = _descend(place, part, change)
    if not isinstance(place, dict):
        raise InputError(f"--set {_shortened(change)}: {_shortened('.'.join(parts[:-1]))} is not a table")
    place[parts[-1]] = value


def _descend(place: Any, part: str, change: str) -> Any:
    if isinstance(place, list):
        for position, entry in enumerate(place, start=1):
            if isinstance(entry, dict) and _number(entry, position) == part:
                return entry
        raise InputError(f"--set {_shortened(change)}: no entry {_shortened(part)}")
    if not isinstance(place, dict):
        raise InputError(f"--set {_shortened(change)}: {_shortened(part)} is not in a table")
    return place.setdefault(part, {})


def _explain(error: ValidationError, data: Mapping[str, Any]) -> str:
    """One line for the first error, of its table an unknown key before all else: field, value, what was expected."""
    found = error.errors(include_url=False)
    unknown = (each for each in found if each["type"] == "extra_forbidden" and each["loc"][:-1] == found[0]["loc"][:-1])
    first = next(unknown, found[0])
    location = first["loc"]
    field = _shortened(_field_name(location, data))
    if first["type"] == "extra_forbidden":
        parent = _model_at(Scenario, location[:-1])
        return f"{field}: unknown key, {did_you_mean(str(location[-1]), parent.model_fields)}"
    if first["type"] == "missing":
        return f"{field}: missing"
    expected = first["msg"].removeprefix("Input should be ")
    match first["type"]:
        case "model_type" | "dict_type":
            expected = "a table"
        case "tuple_type":
            expected = "an array"
        case "string_pattern_mismatch":
            expected = "a line without control characters"
        case "too_short":
            expected = f"at least {first['ctx']['min_length']} entries"
        case "too_long":
            expected = f"{first['ctx']['max_length']} entries"
    return f"{field}: expected {expected}, got {_shortened(repr(first['input']))}"


def _number(entry: Mapping[str, Any], position: int) -> str:
    """What an entry of a list is called by: its ``id``, or its position where it has none that can be printed."""
    number = entry.get("id", position)
    usable = not isinstance(number, int) or -LARGEST_INTEGER <= number <= LARGEST_INTEGER
    return _shortened(str(number)) if usable else str(position)


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}..."


def _field_name(location: Iterable[int | str], data: Any) -> str:
    name = ""
    for part in location:
        entry = None
        if isinstance(data, list) and isinstance(part, int) and part < len(data):
            entry = data[part]
        elif isinstance(data, dict):
            entry = data.get(part)
        if not isinstance(part, int):
            name += f".{part}" if name else part
        elif isinstance(entry, dict) and "id" in entry:
            name += f"[id {_number(entry, part + 1)}]"
        else:
            name += f"[{part + 1}]"
        data = entry
    return name


def _model_at(model: type[BaseModel], location: Sequence[int | str]) -> type[BaseModel]:
    for part in location:
        if isinstance(part, int):
            continue
        annotation = model.model_fields[part].annotation
        model = next(m for m in _flatten(annotation) if isinstance(m, type) and issubclass(m, BaseModel))
    return model


def _flatten(annotation: Any) -> Iterable[Any]:
    yield annotation
    for argument in get_args(annotation):
        yield from _flatten(argument)
