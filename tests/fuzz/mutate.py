"""Mutations of parsed files, structure-aware: values, types, deletions, huge numbers, strings, keys of the schema."""

from __future__ import annotations

import copy
import json
import random
from types import UnionType
from typing import Any, Union, get_args, get_origin

from pydantic import BaseModel

from scenarios.definition.schema import Scenario


class Raw(str):
    """Text that goes into a file as it is."""


NUMBERS: tuple[Any, ...] = (
    *(0, 1, -1, 2, 3, 1000, 2**31, 2**63, -(2**63), 2**70, 10**30, 10**18),
    *(0.0, -0.0, 1.0, 0.5, 1e-9, 1e-12, 1e-308, 5e-324, 1e5, 1e6, 1.0000001e6, 1e300, 1.7e308),
    *(float("inf"), float("-inf"), float("nan"), 0.033, 0.1, 0.135, 0.2, 12.5, 359.999, 360.0, -180.0),
    *(Raw("0x" + "f" * 6000), Raw("1" * 5000), Raw("1e400"), Raw("0b1"), *(Raw("[" * n + "]" * n) for n in (200, 900))),
)
STRINGS = (
    *("", " ", "a", "angle", "own", "none", "pymunk", "unicycle", "bearing", "displacement", "leader", "shape"),
    *("\x1b[31m", "\x9b2J", "a\nb", "\u202e", "\U0001f600", "../../etc/passwd", "/dev/zero", "law.py", "[/red]", "{}"),
    *("%s%n", "x" * 10_000, "3;1,2", "1;2,3", "0;0,0", "9;9,9", "-1;2,3", "nan", "__class__", "title"),
)
OTHERS: tuple[Any, ...] = (True, False, [], {}, [[]], [0.0, 0.0], [1, 2, 3], [{}], {"a": 1}, [None])


EXCLUSIVE = frozenset(
    ("agents", "random_formation", "target", "title", "source", "id", "neighbours", "file", "factory", "parameters")
    + ("edges", "duration_s", "phases", "velocity_known_by", "communication")
)
"""Keys of the schema that rarely go with the others."""


def any_value(rng: random.Random) -> Any:
    """A value that a file might hold where it should not."""
    pool = rng.choice((NUMBERS, NUMBERS, STRINGS, OTHERS))
    return copy.deepcopy(rng.choice(pool))


def near(value: Any, rng: random.Random) -> Any:
    """A value of the same type, so that it reaches deeper than the schema."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return rng.choice((value + 1, value - 1, 0, -value, 2 * value, rng.randint(0, 9)))
    if isinstance(value, float):
        return rng.choice((value * rng.choice((0.0, 1e-6, 0.5, 2.0, 10.0, 1e3, -1.0)), rng.uniform(-2.0, 2.0), 1e6))
    if isinstance(value, str):
        return rng.choice((value[:-1], value + rng.choice("ab;,3 "), value.upper(), rng.choice(STRINGS)))
    if isinstance(value, list):
        changed = copy.deepcopy(value)
        if changed and rng.random() < 0.7:
            rng.choice((lambda: changed.pop(), lambda: changed.append(copy.deepcopy(rng.choice(changed)))))()
        rng.shuffle(changed)
        return changed
    return any_value(rng)


def mutated(data: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """A copy with one to four changes; in half of all cases such that the schema may allow them."""
    changed = copy.deepcopy(data)
    if rng.random() < 0.5:
        changes, most = (_nudge, _set_known, _set_known), 3
    else:
        changes, most = (_replace, _replace, _approach, _approach, _delete, _add, _set_known), 4
    for _ in range(rng.randint(1, most)):
        rng.choice(changes)(changed, rng)
    return changed


def damaged_text(text: bytes, rng: random.Random) -> bytes:
    """Bytes cut, flipped, doubled or put in."""
    content = bytearray(text)
    for _ in range(rng.randint(1, 3)):
        at, length = rng.randrange(len(content) + 1), rng.choice((1, 1, 10, 1000))
        match rng.randrange(5):
            case 0:
                del content[at : at + length]
            case 1:
                del content[at:]
            case 2:
                content[at:at] = content[at : at + length]
            case 3:
                content[at:at] = rng.choice(
                    (b"[", b"{", b'"', b"\n", b"\r", b"\x00", b"\xff", b"=", b"[" * 5000, b"\xef\xbb\xbf")
                )
            case 4 if at < len(content):
                content[at] ^= 1 << rng.randrange(8)
    return bytes(content)


def _places(data: Any) -> list[tuple[Any, Any]]:
    """(container, key) of every value in nested tables and arrays."""
    found, queue = [], [data]
    while queue:
        container = queue.pop()
        keys = list(container) if isinstance(container, dict) else range(len(container))
        for key in keys:
            found.append((container, key))
            if isinstance(container[key], dict | list):
                queue.append(container[key])
    return found


def _replace(data: dict[str, Any], rng: random.Random) -> None:
    if places := _places(data):
        container, key = rng.choice(places)
        container[key] = any_value(rng)


def _approach(data: dict[str, Any], rng: random.Random) -> None:
    if places := _places(data):
        container, key = rng.choice(places)
        container[key] = near(container[key], rng)


def _nudge(data: dict[str, Any], rng: random.Random) -> None:
    """Another number in the place of one."""
    numbers = [(c, k) for c, k in _places(data) if isinstance(c[k], float)]
    if numbers:
        container, key = rng.choice(numbers)
        container[key] = near(container[key], rng)


def _delete(data: dict[str, Any], rng: random.Random) -> None:
    if places := _places(data):
        container, key = rng.choice(places)
        del container[key]


def _add(data: dict[str, Any], rng: random.Random) -> None:
    tables = [data, *(c[k] for c, k in _places(data) if isinstance(c[k], dict))]
    rng.choice(tables)[rng.choice(STRINGS)] = any_value(rng)


def _set_known(data: dict[str, Any], rng: random.Random) -> None:
    """A key of the schema, with a value that it may take as a rule."""
    model: type[BaseModel] = Scenario
    place: Any = data
    while True:
        key = rng.choice([key for key in model.model_fields if key not in EXCLUSIVE or rng.random() < 0.1])
        annotation = model.model_fields[key].annotation
        inner = _model_in(annotation)
        if inner is None or rng.random() < 0.1:
            if isinstance(place, dict):
                place[key] = _of_kind(annotation, rng)
            return
        if not isinstance(place, dict):
            return
        below = place.setdefault(key, [] if get_origin(annotation) is tuple else {})
        if isinstance(below, list):
            if not below or rng.random() < 0.2:
                below.append({})
            below = rng.choice(below)
        model, place = inner, below


def _model_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _model_in(part)) is not None), None)


def _of_kind(annotation: Any, rng: random.Random) -> Any:
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation is bool:
        return rng.random() < 0.5
    if annotation is int:
        return rng.choice((0, 1, 2, 3, 5, 40, 1000, 10**6))
    if annotation is float:
        return rng.choice((0.0, 1e-9, 1e-3, 0.1, 0.15, 0.5, 1.0, 2.0, 10.0, 100.0, 1e4, 1e6, -0.5, rng.uniform(-2, 2)))
    if annotation is str:
        return rng.choice(STRINGS)
    if origin is tuple:
        kinds = arguments[:1] * rng.randint(0, 4) if len(arguments) == 2 and arguments[1] is ... else arguments
        return [_of_kind(kind, rng) for kind in kinds]
    if origin in (Union, UnionType):
        return _of_kind(rng.choice([a for a in arguments if a is not type(None)]), rng)
    if arguments and all(isinstance(a, str) for a in arguments):
        return rng.choice(arguments)
    return _of_kind(arguments[0], rng) if arguments else any_value(rng)


def toml(data: dict[str, Any]) -> str:
    """Data as TOML, nested tables in line."""
    return "".join(f"{json.dumps(str(key))} = {_toml(value)}\n" for key, value in data.items() if value is not None)


def _toml(value: Any) -> str:
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(str(k))} = {_toml(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(v) for v in value if v is not None) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)
