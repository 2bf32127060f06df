"""The scenarios that come with the project, and what tells each from the others.

That much is read from a file as it stands, without the schema, whose tables take longer to load than all files to read.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Final

LIBRARY = Path(__file__).parents[2] / "library"
"""Folder of the scenarios that come with the project."""

DEFAULT_PLANT: Final = "pymunk"
"""The plant of a scenario that names none."""


def library() -> list[str]:
    """Names of the scenarios that come with the project."""
    return sorted(path.stem for path in LIBRARY.glob("*.toml"))


def describe_library() -> list[dict[str, Any]]:
    """The scenarios that come with the project, each with what tells it from the others."""
    return [_described(name, tomllib.loads((LIBRARY / f"{name}.toml").read_text("utf-8"))) for name in library()]


def _described(name: str, tables: dict[str, Any]) -> dict[str, Any]:
    formation = tables.get("random_formation")
    seconds = tables.get("duration_s") or sum(phase["duration_s"] for phase in tables["phases"])
    return {
        "scenario": name,
        "agents": len(tables["agents"]) if formation is None else formation["agents"],
        "duration_s": float(seconds),
        "plant": tables.get("plant", {}).get("name", DEFAULT_PLANT),
        "title": tables["title"],
    }
