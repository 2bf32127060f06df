"""A Python function as a reference: executed when its scenario is read, whose points its values become.

A scenario with these points needs the function no more: a run folder has the points. Loads no numpy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from scenarios.definition.files import law_file
from scenarios.errors import InputError, did_you_mean

INTERVAL = 0.1
"""Seconds between two points: a cubic spline through them errs by 5e-6 of the fourth derivative at most."""

MOST_POINTS = 100_000

MEANINGS = ("x_m", "y_m", "scale", "turn_deg")
"""What the function returns; the last two may be left out."""


def read_points(path: Path, name: str | None, seconds: float, scenario: str) -> list[dict[str, Any]]:
    """The way-points of the function ``name`` in a Python file, from 0 to the end of a run of so many seconds.

    Raises:
        InputError: no such file or function, or it raises or returns something else; the message names the line.
    """
    if name is None:
        raise InputError(f"{scenario}: reference.function: missing, the name of a function in {path}")
    if not 0.0 < seconds <= MOST_POINTS * INTERVAL:
        raise InputError(f"{scenario}: duration_s: expected up to {MOST_POINTS * INTERVAL:g} s of a function")
    file = law_file.read(scenario, path.parent, path.name, "reference.file")
    module = file.execute()
    way = getattr(module, name, None)
    if not callable(way):
        names = law_file.defined(module)
        known = did_you_mean(name, names) if names else "it has none at all"
        raise InputError(f"{scenario}: reference.function: {path} has no function {name!r}, {known}")
    count = max(2, math.ceil(seconds / INTERVAL) + 1)
    times = [seconds * k / (count - 1) for k in range(count)]
    return [_point(t, _asked(file, name, way, t), f"{path}: {name}({t:g})") for t in times]


def _asked(file: law_file.LawFile, name: str, way: Callable[[float], Any], t: float) -> tuple[float, ...]:
    try:
        return tuple(float(value) for value in way(t))
    except (Exception, SystemExit) as error:
        raise file.failure(f"{name}({t:g})", error) from error


def _point(t: float, values: tuple[float, ...], place: str) -> dict[str, Any]:
    if len(values) not in (2, 4) or not all(map(math.isfinite, values)):
        raise InputError(f"{place}: expected (x_m, y_m) or ({', '.join(MEANINGS)}), finite, got {values!r:.80}")
    x, y, *rest = values
    if rest and rest[0] <= 0.0:
        raise InputError(f"{place}: scale: expected above 0, got {rest[0]:g}")
    return {"t_s": t, "position_m": [x, y], **dict(zip(MEANINGS[2:], rest, strict=False))}
