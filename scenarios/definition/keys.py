"""The reference of the scenario file, read off its schema."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, cast, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from scenarios.definition.schema import Scenario
from scenarios.documents import markdown_table


@dataclass(frozen=True)
class Key:
    """One key of the scenario file: its dotted name, what it may be, its default and what it means."""

    name: str
    kind: str
    default: str
    meaning: str


def keys(table: type[BaseModel] = Scenario, prefix: str = "") -> Iterator[Key]:
    """Every key, tables before their own keys; a list of tables is written ``name[]``."""
    meanings = docstrings(table)
    for name, field in table.model_fields.items():
        inner = _table(field.annotation)
        listed = get_origin(field.annotation) is tuple and inner is not None
        full = f"{prefix}{name}{'[]' if listed else ''}"
        meaning = " ".join((meanings.get(name) or (inner.__doc__ if inner else "") or "").split())
        if inner is None:
            yield Key(full, _kind(field), _default(field), meaning)
        else:
            yield Key(full, "list of tables" if listed else "table", "", meaning)
            yield from keys(inner, f"{full}.")


def docstrings(table: type[BaseModel]) -> dict[str, str]:
    """The docstring below each attribute of a table, by name; attributes without one are left out."""
    (definition,) = ast.parse(inspect.getsource(table)).body
    return {
        attribute.target.id: below.value.value
        for attribute, below in pairwise(cast(ast.ClassDef, definition).body)
        if isinstance(attribute, ast.AnnAssign)
        and isinstance(attribute.target, ast.Name)
        and isinstance(below, ast.Expr)
        and isinstance(below.value, ast.Constant)
        and isinstance(below.value.value, str)
    }


def markdown() -> str:
    """The reference as a Markdown page."""
    lines = ["# The scenario file", "", "Written by `formation keys --markdown docs/scenario-file.md`.", ""]
    rows = [(f"`{key.name}`", key.kind, _code(key.default), key.meaning) for key in keys()]
    lines += markdown_table(("key", "kind", "default", "meaning"), rows)
    return "\n".join(lines) + "\n"


def _code(text: str) -> str:
    return f"`{text}`" if text else ""


def _table(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type):
        return annotation if issubclass(annotation, BaseModel) else None
    found = (_table(argument) for argument in get_args(annotation))
    return next((table for table in found if table is not None), None)


def _kind(field: FieldInfo) -> str:
    return _name(field.annotation)


def _name(annotation: Any) -> str:
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return ", ".join(f'"{value}"' for value in arguments)
    if origin is tuple:
        if arguments[-1] is Ellipsis:
            return f"list of {_name(arguments[0])}"
        return f"[{', '.join(_name(argument) for argument in arguments)}]"
    if origin is dict:
        return f"table of {_name(arguments[1])}"
    if arguments and origin is not None and hasattr(annotation, "__metadata__"):
        return _name(arguments[0])
    if arguments:
        return " or ".join(_name(argument) for argument in arguments if argument is not type(None))
    return {float: "number", int: "integer", bool: "true or false", str: "text"}.get(annotation, str(annotation))


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is None or value == () or value == {}:
        return ""
    if isinstance(value, tuple):
        return str(list(value))
    return str(value).lower() if isinstance(value, bool) else str(value)
