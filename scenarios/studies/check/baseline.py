"""The baseline file of a scenario: what runs, what each gave, and on which machine."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scenarios.definition.experiment import Experiment
from scenarios.definition.files.library import library
from scenarios.definition.files.reading import read_regular
from scenarios.errors import InputError, did_you_mean
from scenarios.storage.files import write_whole

FOLDER = Path(__file__).parents[2] / "baselines"
"""The library's baselines."""

SCHEMA_VERSION = 1

SEEDS = {"single_integrator": (0,), "unicycle": (0,), "saturated": (0, 1), "pymunk": (0, 1, 2)}
"""Seeds on each plant, where a baseline does not say otherwise."""

FILTER_OFF = "safety.filter=none"

ANEW = "delete it and make it anew with --update"


class Entry(BaseModel):
    """A part of the file: no unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Case(Entry):
    """What runs: may be edited, and ``formation check --update`` runs it.

    Attributes:
        plant: the world.
        seeds: one run each.
        changes: ``key=value`` texts, as with ``--set``.
    """

    plant: str
    seeds: tuple[Annotated[int, Field(ge=0)], ...]
    changes: tuple[str, ...] = ()


class Which(Entry):
    """Names a run.

    Attributes:
        plant, seed, changes: as in its case.
    """

    plant: str
    seed: int
    changes: tuple[str, ...] = ()

    @property
    def key(self) -> tuple[str, int, tuple[str, ...]]:
        return self.plant, self.seed, self.changes


class Run(Which):
    """What one run gave.

    Attributes:
        numbers: by name, the value and how far another machine may be off.
        texts: by name; they have to be equal.
    """

    numbers: dict[str, tuple[float | None, float]]
    texts: dict[str, str]


class LeftOut(Which):
    """A run that another machine cannot reproduce.

    Attributes:
        reason: what differs.
    """

    reason: str


class Baseline(Entry):
    """The whole file.

    Attributes:
        schema_version: of this file's form.
        scenario: a library name, or a path relative to the folder of the baseline.
        scenario_sha256: digest of the scenario's content when the runs were made.
        machine: :func:`scenarios.studies.check.machine.fingerprint` of the machine that made the runs.
        cases: what runs.
        runs: what each run gave.
        left_out: runs of the cases that are not compared.
    """

    schema_version: int
    scenario: str
    scenario_sha256: str
    machine: dict[str, str]
    cases: tuple[Case, ...]
    runs: tuple[Run, ...]
    left_out: tuple[LeftOut, ...] = ()


def default_cases(experiment: Experiment) -> tuple[Case, ...]:
    """Every plant, and where the scenario has a safety filter, the robots without it."""
    cases = [Case(plant=plant, seeds=seeds) for plant, seeds in SEEDS.items()]
    filtered = experiment.scenario.model_dump().get("safety", {}).get("filter", "none") != "none"
    if filtered:
        cases.append(Case(plant="pymunk", seeds=SEEDS["pymunk"], changes=(FILTER_OFF,)))
    return tuple(cases)


def baselines_in(folder: Path) -> list[Path]:
    """The baseline files of a folder.

    Raises:
        InputError: the folder does not exist.
    """
    if not folder.is_dir():
        raise InputError(f"--baselines {folder}: no such folder")
    return sorted(folder.glob("*.json"), key=lambda path: path.stem)


def path_of(scenario: str, folder: Path) -> Path:
    """Where the baseline of a scenario, a library name or a path, is or goes."""
    return folder / f"{Path(scenario).stem if _is_path(scenario) else scenario}.json"


def reference(scenario: str, folder: Path) -> str:
    """How a baseline in ``folder`` names its scenario."""
    return Path(os.path.relpath(scenario, folder)).as_posix() if _is_path(scenario) else scenario


def scenario_of(baseline: Baseline, folder: Path) -> str:
    """The scenario's name or path that a baseline in ``folder`` names."""
    return os.path.normpath(folder / baseline.scenario) if _is_path(baseline.scenario) else baseline.scenario


def _is_path(scenario: str) -> bool:
    return scenario.endswith(".toml") or "/" in scenario


def read(path: Path) -> Baseline:
    """Read a baseline.

    Raises:
        InputError: the file is missing, damaged or of another schema.
    """
    try:
        content = json.loads(read_regular(path))
    except FileNotFoundError as error:
        known = sorted(found.stem for found in path.parent.glob("*.json")) or library()
        hint = did_you_mean(path.stem, known)
        raise InputError(f"{path}: no such baseline, `formation check --update` makes one; {hint}") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: damaged: {error}; {ANEW}") from error
    version = content.get("schema_version") if isinstance(content, dict) else None
    if version != SCHEMA_VERSION:
        raise InputError(f"{path}: schema_version: expected {SCHEMA_VERSION}, got {version!r}; {ANEW}")
    try:
        return Baseline.model_validate(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {field}: {first['msg']}; {ANEW}") from None


def write(path: Path, baseline: Baseline) -> None:
    """Write a baseline, whole or not at all.

    Raises:
        InputError: it cannot be written.
    """
    write_whole(path, _text(baseline.model_dump(mode="json")).encode())


def _text(content: dict[str, Any]) -> str:
    """JSON with innermost lists on one line, so that each number has its own line in a diff."""
    text = json.dumps(content, indent=1, allow_nan=False)
    return re.sub(r"\[\n[^\[\]{}]*\]", _on_one_line, text) + "\n"


def _on_one_line(match: re.Match[str]) -> str:
    return re.sub(r"\n\s*", " ", match[0]).replace("[ ", "[").replace(" ]", "]")
