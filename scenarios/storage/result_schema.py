"""What ``result.json`` holds, as far as anything reads it again. What is not so is named by its field."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scenarios.errors import InputError

SCHEMA_VERSION = 1

LONGEST_VALUE = 80
"""Characters of a refused value that a message repeats."""

NotNegative = Annotated[float, Field(ge=0.0)]
Positive = Annotated[float, Field(gt=0.0)]
AgentNumber = Annotated[int, Field(ge=1)]


class Part(BaseModel):
    """A part of the file: no type is turned into another, every number is finite; keys that are not read may follow."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False, defer_build=True)


class Angle(Part):
    """One measured angle; null where a diverged run has none."""

    name: str
    target_deg: float
    final_deg: float | None
    error_rad: float | None
    axle_error_rad: float | None


class MinSeparation(Part):
    """The closest pair."""

    distance_m: NotNegative | None
    time_s: NotNegative
    agents: Annotated[list[AgentNumber], Field(min_length=2, max_length=2)]


class Violation(Part):
    """One kind of rule that the testbed's checker found broken."""

    kind: str


class Testbed(Part):
    """The testbed's verdict."""

    accepted: bool
    violations: list[Violation]


class PhaseEnd(Part):
    """The end of a phase."""

    name: str
    end_s: NotNegative
    angle_errors_rad: list[float | None]


class Result(Part):
    """The whole file."""

    scenario: Annotated[str, Field(pattern=r"^[^/\x00-\x1f\x7f-\x9f]+$")]
    scenario_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    seed: Annotated[int, Field(ge=0)]
    plant: str
    safety: str
    versions: dict[str, str]
    duration_s: NotNegative
    planned_duration_s: Positive
    asked_duration_s: Positive | None = None
    outcome: Literal["converged", "not_converged", "rejected", "diverged"]
    goal_rad: Positive
    angles: list[Angle]
    angle_error_sum_rad: NotNegative | None
    axle_angle_error_sum_rad: NotNegative | None
    settling_time_s: NotNegative | None
    min_separation: MinSeparation
    testbed: Testbed
    phases: list[PhaseEnd]


def check(path: Path, content: Any) -> Result:
    """What is read of a result; ``path`` is that of its file, for messages.

    Raises:
        InputError: it is of another version, or not a result.
    """
    if not isinstance(content, dict):
        raise InputError(f"{path}: expected a JSON object, got {type(content).__name__}")
    version = content.get("schema_version")
    if version != SCHEMA_VERSION or isinstance(version, bool):
        newer = isinstance(version, int) and version > SCHEMA_VERSION
        hint = "written by a newer version of this program, read it with that one" if newer else "make the run again"
        raise InputError(f"{path}: schema_version: expected {SCHEMA_VERSION}, got {_shortened(version)}; {hint}")
    try:
        return Result.model_validate(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
    field = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    if first["type"] == "missing":
        raise InputError(f"{path}: {field}: missing")
    expected = first["msg"].removeprefix("Input should be ")
    raise InputError(f"{path}: {field}: expected {expected}, got {_shortened(first['input'])}")


def _shortened(value: object) -> str:
    try:
        text = repr(value)
    except RecursionError:
        return "something nested too deeply"
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}..."
