"""The digest of a scenario: equal for files that mean the same, different after any change of what is run."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Mapping
from typing import Any, cast

from pydantic import BaseModel

from scenarios.definition.files.law_file import LawFile
from scenarios.definition.schema import Scenario

OWN_LAW_KEYS = ("file", "factory", "parameters")
"""Keys of the table ``law`` that only an own law has."""

LATER_KEYS = (
    ("goal", "accepted"),
    ("graph",),
    ("sensor", "distance_noise_m"),
    ("sensor", "angle_noise_deg"),
    ("sensor", "ratio_noise"),
    ("sensor", "edge_loss"),
    ("sensor", "dropout"),
    ("robot", "model"),
    ("robot", "file"),
    ("robot", "numbers"),
    ("robot", "base_spread"),
    ("robot", "radius_spread"),
    ("reference",),
    ("law", "feedforward"),
    ("law", "without_neighbour"),
    ("communication", "message_loss"),
    ("sensor", "sensing_range_m"),
    ("sensor", "field_of_view_deg"),
    ("events",),
    ("goal", "distance_m"),
    ("law", "gain"),
    ("leaders",),
    ("sensor", "own_motion"),
    ("sensor", "gyro_noise_deg_s"),
    ("sensor", "encoder_noise_m_s"),
)
"""Keys that came after the first baselines: at their defaults they are not in a scenario's digest."""


def digest(content: Mapping[str, Any], own_law: LawFile | None) -> str:
    """Digest of a validated scenario's content as JSON has it; see :attr:`ScenarioFile.sha256`."""
    data = copy.deepcopy(dict(content))
    without_later_keys(data)
    law = data.setdefault("law", {})
    if own_law is not None:
        law["file"] = own_law.sha256
    else:
        for key in OWN_LAW_KEYS:
            law.pop(key, None)
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def without_later_keys(data: dict[str, Any]) -> None:
    """Take the keys of :data:`LATER_KEYS` that have their defaults out of a scenario's dumped ``data``.

    An agent without a robot or a gain of its own likewise has no such key.
    """
    for agent in data.get("agents", ()):
        for key in ("robot", "gain"):
            if agent.get(key, ()) is None:
                del agent[key]
    for *tables, key in LATER_KEYS:
        place: Any = data
        model: type[BaseModel] = Scenario
        for table in tables:
            place, model = place.get(table, {}), cast(type[BaseModel], model.model_fields[table].annotation)
        default = model.model_fields[key].default
        if key in place and place[key] == (list(default) if isinstance(default, tuple) else default):
            del place[key]
